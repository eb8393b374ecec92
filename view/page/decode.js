// What view/view.cpp wrote, as arrays.
async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Numbers of 16 bits that lie as all lower bytes, then all upper bytes.
function join16(bytes, first, count) {
  const numbers = new Uint16Array(count);
  for (let i = 0; i < count; ++i) numbers[i] = bytes[first + i] | bytes[first + count + i] << 8;
  return numbers;
}

async function decodeShape(shape) {
  const bytes = await unpack(shape.vertices), n = shape.vertexCount;
  const planes = join16(bytes, 0, 3 * n);
  const vertices = new Uint16Array(4 * n); // padded: attributes lie on multiples of four bytes
  for (let v = 0; v < n; ++v) for (let axis = 0; axis < 3; ++axis) vertices[4 * v + axis] = planes[axis * n + v];
  const indices = new Uint32Array((await unpack(shape.indices)).buffer);
  const extent = shape.high.map((high, axis) => high - shape.low[axis]);
  let first = 0;
  const levels = shape.levels.map(count => { const level = {first, count}; first += count; return level; });
  const farthest = shape.low.map((low, axis) => Math.max(Math.abs(low), Math.abs(shape.high[axis])));
  return {name: shape.name, low: shape.low, extent, vertices, indices, levels, radius: Math.hypot(...farthest)};
}

// Poses: [body][number][kept step], numbers being x y z and the quaternion.
async function decodeMotion(motion, bodies) {
  const numbers = join16(await unpack(motion.numbers), 0, bodies * 7 * motion.kept);
  for (let i = 0; i < numbers.length; ++i) if (i % motion.kept) numbers[i] += numbers[i - 1];
  const {low, high, kept} = motion;
  return {
    kept, stride: motion.stride,
    // Writes position and unit quaternion of a body to out[at ... at + 6].
    pose(body, k, out, at) {
      const from = body * 7 * kept + k;
      for (let axis = 0; axis < 3; ++axis)
        out[at + axis] = low[axis] + numbers[from + axis * kept] / 65535 * (high[axis] - low[axis]);
      let square = 0;
      for (let n = 3; n < 7; ++n) {
        const part = numbers[from + n * kept] / 65535 * 2 - 1;
        out[at + n] = part;
        square += part * part;
      }
      for (let n = 3; n < 7; ++n) out[at + n] /= Math.sqrt(square);
    }
  };
}

// A direction of two bytes on an octahedron.
function direction(word) {
  let x = (word & 255) / 127.5 - 1, y = (word >> 8) / 127.5 - 1;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

// Columns of one step's contacts or predictions as a list of segments.
async function decodeSegments(text, count, layers, contacts) {
  if (!count) return [];
  const bytes = await unpack(text);
  const column = i => join16(bytes, 2 * i * count, count);
  const device = column(0), place = [column(1), column(2), column(3)], along = column(4), length = column(5);
  const normal = contacts ? column(6) : null, depth = contacts ? column(7) : null;
  const segments = [];
  for (let i = 0; i < count; ++i) {
    const point = place.map((c, axis) => layers.low[axis] + c[i] / 65535 * (layers.high[axis] - layers.low[axis]));
    const l = length[i] / 65535 * layers.length;
    segments.push({
      device: device[i], point, hit: direction(along[i]).map((d, axis) => point[axis] + l * d),
      normal: normal ? direction(normal[i]) : null, depth: depth ? depth[i] / 65535 * layers.depth : 0
    });
  }
  return segments;
}
