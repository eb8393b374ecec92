// Orbits about a point; z is up.
const focal = 1.8; // half the height of the picture is 1 at this distance

class Camera {
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.changed = changed;
    this.yaw = -0.9; this.pitch = 0.5; this.distance = 10; this.target = [0, 0, 0];
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', e => { canvas.setPointerCapture(e.pointerId); this.pointers.set(e.pointerId, e); });
    for (const end of ['pointerup', 'pointercancel'])
      canvas.addEventListener(end, e => this.pointers.delete(e.pointerId));
    canvas.addEventListener('pointermove', e => this.drag(e));
    canvas.addEventListener('contextmenu', e => e.preventDefault());
    canvas.addEventListener('wheel', e => { if (framed && !document.hasFocus()) return; e.preventDefault(); this.zoom(Math.exp(e.deltaY * (e.deltaMode ? 0.03 : 0.001))); }, {passive: false});
  }

  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    return {right: [-sy, cy, 0], up: [-cy * sp, -sy * sp, cp], back: [cy * cp, sy * cp, sp]};
  }

  drag(e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    if (this.pointers.size === 2) { // two fingers: zoom by their distance, move by their middle
      const [other] = [...this.pointers.values()].filter(p => p.pointerId !== e.pointerId);
      const span = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
      this.distance *= Math.max(span(before), 1) / Math.max(span(e), 1);
      this.move(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) {
      this.move(dx, dy);
    } else {
      this.yaw -= 0.008 * dx;
      this.pitch = Math.min(1.55, Math.max(-1.55, this.pitch + 0.008 * dy));
    }
    this.pointers.set(e.pointerId, e);
    this.changed();
  }

  move(dx, dy) {
    const {right, up} = this.axes(), scale = 2 * this.distance / focal / this.canvas.clientHeight;
    for (let k = 0; k < 3; ++k) this.target[k] += scale * (dy * up[k] - dx * right[k]);
  }

  zoom(factor) { this.distance *= factor; this.changed(); }

  // The middle of most bodies, and all of these in view. balls: [x, y, z, radius].
  fit(balls) {
    if (!balls.length) return;
    const at = (values, part) => values[Math.round(part * (values.length - 1))];
    let square = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const low = balls.map(b => b[axis] - b[3]).sort((a, b) => a - b), high = balls.map(b => b[axis] + b[3]).sort((a, b) => a - b);
      this.target[axis] = (at(low, 0.02) + at(high, 0.98)) / 2;
      square += (at(high, 0.98) - at(low, 0.02)) ** 2;
    }
    const aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    this.distance = 0.5 * Math.sqrt(square) * focal / Math.min(1, aspect) * 0.9 + 1e-3;
    this.changed();
  }

  // From the world to the picture; column by column, as WebGL takes it.
  matrix() {
    const {right, up, back} = this.axes();
    this.eye = this.target.map((t, k) => t + this.distance * back[k]);
    const aspect = this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
    const near = 0.02 * this.distance, far = 30 * this.distance, m = new Float32Array(16);
    [[focal / aspect, right], [focal, up], [(far + near) / (near - far), back], [-1, back]].forEach(([scale, axis], row) => {
      for (let k = 0; k < 3; ++k) m[4 * k + row] = scale * axis[k];
      m[12 + row] = -scale * (axis[0] * this.eye[0] + axis[1] * this.eye[1] + axis[2] * this.eye[2]);
    });
    m[14] += 2 * far * near / (near - far);
    return m;
  }
}
