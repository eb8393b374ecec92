// Draws the bodies of a step: instances of each shape's levels of detail.
const instanceFloats = 10; // place, turn, tint

const tintOf = colour => [16, 8, 0].map(bits => (colour >> bits & 255) / 255);

class Bodies {
  constructor(gl, shapes, list, motion) {
    this.gl = gl; this.shapes = shapes; this.motion = motion;
    this.shader = compile(gl, bodyVertex, bodyFragment);
    this.list = list.map(([shape, first, end, colour]) => ({shape, first, end, faint: false, tint: tintOf(colour)}));
    this.parts = shapes.map(shape => this.upload(shape));
    this.pose = new Float32Array(7);
    this.triangles = 0; // drawn in the last frame
  }

  upload(shape) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, shape.vertices, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 8, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, shape.indices, gl.STATIC_DRAW);
    const instances = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    [[1, 3, 0], [2, 4, 12], [3, 3, 28]].forEach(([place, count, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * instanceFloats, offset);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
    return {array, instances, levels: shape.levels.map(() => [])};
  }

  // The coarsest level that still has a triangle for some pixels.
  level(shape, pixels, detail) {
    const wanted = 0.2 * detail * pixels * pixels;
    let level = shape.levels.length - 1;
    while (level > 0 && shape.levels[level].count / 3 < wanted) --level;
    return level;
  }

  // detail: 1 for a picture that stands, less where frames take too long.
  draw(k, step, camera, toClip, detail, clear) {
    this.triangles = 0;
    for (const faint of [false, true]) this.drawAll(body => (clear || body.faint) === faint, k, step, camera, toClip, detail, faint);
  }

  drawAll(wanted, k, step, camera, toClip, detail, clear) {
    const gl = this.gl, {uniforms} = this.shader, perUnit = camera.canvas.clientHeight * focal;
    for (const part of this.parts) for (const level of part.levels) level.length = 0;
    this.list.forEach((body, number) => {
      if (step < body.first || step >= body.end || !wanted(body)) return;
      this.motion.pose(number, k, this.pose, 0);
      const shape = this.shapes[body.shape];
      const away = Math.max(Math.hypot(...camera.eye.map((e, axis) => e - this.pose[axis])), 1e-9);
      const level = this.level(shape, shape.radius / away * perUnit, detail);
      this.parts[body.shape].levels[level].push(...this.pose, ...body.tint);
    });
    gl.useProgram(this.shader.program);
    gl.uniformMatrix4fv(uniforms.toClip, false, toClip);
    gl.uniform3fv(uniforms.eye, camera.eye);
    gl.uniform1f(uniforms.alpha, clear ? 0.22 : 1);
    (clear ? gl.enable : gl.disable).call(gl, gl.BLEND);
    gl.depthMask(!clear);
    this.shapes.forEach((shape, s) => {
      const part = this.parts[s];
      gl.bindVertexArray(part.array);
      gl.uniform3fv(uniforms.low, shape.low);
      gl.uniform3fv(uniforms.extent, shape.extent);
      gl.bindBuffer(gl.ARRAY_BUFFER, part.instances);
      part.levels.forEach((instances, l) => {
        if (!instances.length) return;
        const {first, count} = shape.levels[l], bodies = instances.length / instanceFloats;
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(instances), gl.STREAM_DRAW);
        gl.drawElementsInstanced(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first, bodies);
        this.triangles += count / 3 * bodies;
      });
    });
    gl.bindVertexArray(null);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // Balls about the bodies that are there, without those much larger than the rest.
  balls(k, step) {
    const balls = [], radii = [];
    this.list.forEach((body, number) => {
      if (step < body.first || step >= body.end) return;
      this.motion.pose(number, k, this.pose, 0);
      balls.push([this.pose[0], this.pose[1], this.pose[2], this.shapes[body.shape].radius]);
      radii.push(this.shapes[body.shape].radius);
    });
    const middle = median(radii);
    const small = balls.filter(ball => ball[3] <= 6 * middle);
    return small.length > 1 ? small : balls;
  }

  // Those of a step that have not fallen or flown far from where all began.
  gathered(k, step) {
    const first = this.balls(0, 0), now = this.balls(k, step);
    if (!first.length || !now.length) return now;
    const both = first.concat(now), centre = [0, 1, 2].map(axis => median(both.map(ball => ball[axis])));
    const away = ball => Math.hypot(...centre.map((c, axis) => ball[axis] - c)) - ball[3];
    const most = 2.5 * Math.max(median(first.map(away)), 2 * median(first.map(ball => ball[3])));
    const near = now.filter(ball => away(ball) <= most);
    return near.length ? near : now;
  }
}
