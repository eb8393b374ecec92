// Rays, hits, contacts, normals and predictions of some steps, over the bodies: they lie inside of them.
const layerNames = {
  contacts: 'Contacts: the vertices inside another body',
  rays: 'Rays: from the vertex to the hit',
  hits: 'Hits: where the ray leaves the other body',
  normals: 'Contact normals, from body A to body B',
  predictions: 'Predictions: vertices about to touch, and the face ahead (method predictive)'
};
const deviceColours = [[0.18, 0.44, 0.85], [0.93, 0.45, 0.13], [0.2, 0.65, 0.35], [0.7, 0.3, 0.75], [0.85, 0.7, 0.1], [0.1, 0.65, 0.7], [0.85, 0.25, 0.35], [0.5, 0.5, 0.5]];
const depthStops = [[0.1, 0.35, 0.95], [0.1, 0.85, 0.75], [0.98, 0.85, 0.2], [0.95, 0.15, 0.1]];

const beyondColour = [0.45, 0, 0.6]; // deeper than the ramp's end
const metres = x => {
  const mm = +(1000 * x).toPrecision(2);
  return mm < 1000 ? `${mm} mm` : `${+x.toPrecision(3)} m`;
};

function depthColour(part) {
  const at = Math.max(0, Math.min(0.9999, part)) * (depthStops.length - 1), i = Math.floor(at), f = at - i;
  return depthStops[i].map((c, k) => c + f * (depthStops[i + 1][k] - c));
}
const css = c => `rgb(${c.map(x => Math.round(255 * x)).join(' ')})`;

// Points and lines over the bodies: place, colour, alpha.
class Marks {
  constructor(gl, pointSize, leastPixels = 2.5) {
    this.gl = gl; this.pointSize = pointSize; this.leastPixels = leastPixels;
    this.shader = compile(gl, layerVertex, layerFragment);
    this.buffers = null;
  }

  show(lines, points) {
    if (this.buffers) for (const old of this.buffers) { this.gl.deleteBuffer(old.buffer); this.gl.deleteVertexArray(old.array); }
    this.buffers = [this.upload(lines, this.gl.LINES), this.upload(points, this.gl.POINTS)];
  }

  upload(numbers, kind) {
    const gl = this.gl, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 28, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.FLOAT, false, 28, 12);
    gl.bindVertexArray(null);
    return {array, buffer, kind, count: numbers.length / 7};
  }

  draw(toClip, pixelsAtOne, pixelRatio) {
    if (!this.buffers) return 0;
    const gl = this.gl, {program, uniforms} = this.shader;
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.toClip, false, toClip);
    gl.uniform1f(uniforms.size, this.pointSize);
    gl.uniform1f(uniforms.scale, pixelsAtOne);
    gl.uniform1f(uniforms.least, this.leastPixels * pixelRatio);
    gl.disable(gl.DEPTH_TEST);
    let drawn = 0;
    for (const {array, kind, count} of this.buffers) {
      gl.uniform1i(uniforms.round, kind === gl.POINTS ? 1 : 0);
      gl.bindVertexArray(array);
      if (count) gl.drawArrays(kind, 0, count);
      drawn += count;
    }
    gl.bindVertexArray(null);
    gl.enable(gl.DEPTH_TEST);
    return drawn;
  }
}

class Layers extends Marks {
  constructor(gl, layers, size) { // size: a typical body's radius, metres
    super(gl, 0.05 * size);
    this.layers = layers;
    this.normalLength = 0.5 * size;
    this.steps = layers.steps.map(s => s.step);
    this.cache = new Map();
    this.key = '';
    // One contact far deeper than the others must not make all others one colour: the ramp ends at a high percentile,
    // and what lies beyond has a colour of its own. Steps without layers count for the deepest, too.
    this.deepest = layers.depth;
    this.deepestStep = layers.depths.reduce((best, depth, step) => depth > layers.depths[best] ? step : best, 0);
    this.most = layers.depths[this.deepestStep];
  }

  // The last step with layers that is not after this one.
  at(step) {
    let low = 0, high = this.steps.length - 1;
    while (low < high) { const middle = low + high + 1 >> 1; if (this.steps[middle] <= step) low = middle; else high = middle - 1; }
    return low;
  }

  async load(i) {
    if (!this.cache.has(i)) {
      const s = this.layers.steps[i];
      this.cache.set(i, {
        contacts: await decodeSegments(s.contactData, s.contacts, this.layers, true),
        predictions: await decodeSegments(s.predictionData, s.predictions, this.layers, false)
      });
      if (this.cache.size > 8) this.cache.delete(this.cache.keys().next().value);
    }
    return this.cache.get(i);
  }

  async ramp() { // the 98th percentile of the depths of the last step with layers
    const last = await this.load(this.steps.length - 1);
    const depths = last.contacts.map(c => c.depth).sort((a, b) => a - b);
    if (depths.length) this.deepest = depths[Math.floor(0.98 * (depths.length - 1))] || this.layers.depth;
  }

  colour(segment, by) {
    return by === 'device' ? deviceColours[segment.device % deviceColours.length] : segment.depth > 1.01 * this.deepest ? beyondColour : depthColour(segment.depth / (this.deepest || 1));
  }

  // Makes the buffers of what is wanted. shown: names of layers.
  async prepare(i, shown, by) {
    const key = [i, by, ...shown].join();
    if (key === this.key) return;
    const found = await this.load(i), points = [], lines = [];
    const put = (to, place, colour, alpha) => to.push(...place, ...colour, alpha);
    for (const c of found.contacts) {
      const colour = this.colour(c, by);
      if (shown.includes('hits')) put(points, c.hit, [0.08, 0.08, 0.1], 1);
      if (shown.includes('rays')) { put(lines, c.point, colour, 1); put(lines, c.hit, colour, 1); }
      if (shown.includes('normals')) {
        put(lines, c.point, [0.9, 0.2, 0.75], 1);
        put(lines, c.point.map((p, axis) => p + this.normalLength * c.normal[axis]), [0.9, 0.2, 0.75], 1);
      }
      if (shown.includes('contacts')) put(points, c.point, colour, 1);
    }
    if (shown.includes('predictions'))
      for (const p of found.predictions) {
        const colour = by === 'device' ? this.colour(p, by) : [0.55, 0.9, 0.3];
        put(lines, p.point, colour, 1); put(lines, p.hit, colour, 1);
        put(points, p.point, colour, 1);
      }
    this.show(lines, points);
    this.key = key;
  }
}
