// Draws when something changed, and once more in full detail when nothing did for a while.
const recording = JSON.parse(element('recording').textContent);
const canvas = element('stage');
const gl = canvas.getContext('webgl2', {alpha: false, antialias: true, powerPreference: 'high-performance'});
if (!gl) throw new Error('This page needs WebGL 2, which this browser does not offer here. Try a current Firefox, Chrome or Safari with graphics acceleration.');

const shapes = await Promise.all(recording.shapes.map(decodeShape));
const motion = await decodeMotion(recording.motion, recording.bodies.length);
const bodies = new Bodies(gl, shapes, recording.bodies, motion);
const radius = median(recording.bodies.map(([shape]) => shapes[shape].radius));
const layers = recording.layers ? new Layers(gl, recording.layers, radius) : null;
if (layers) await layers.ramp();

let dirty = true, moved = 0, detail = 1, before = null, frames = 0;
const changed = () => { dirty = true; moved = performance.now(); };
const camera = new Camera(canvas, changed);
const controls = new Controls(recording, motion, changed);
const clashes = recording.clashes ? new Clashes(gl, recording, bodies, camera, changed) : null;
const fit = () => camera.fit(bodies.gathered(motion.kept - 1, recording.steps - 1));
element('frame').onclick = canvas.ondblclick = fit;
new ResizeObserver(changed).observe(canvas);

const finest = recording.shapes.reduce((sum, s) => sum + s.triangles, 0);
element('about').textContent = clashes ? `${recording.scene}: ${counted(recording.bodies.length, 'part', 'parts')}, ${counted(recording.clashes.length, 'clash', 'clashes')}. Lengths are in the unit of the file.` : `${recording.scene}: ${counted(recording.bodies.length - recording.standing, 'moving body', 'moving bodies')}, ${recording.standing} standing still, ${counted(recording.shapes.length, 'shape', 'shapes')} of ${finest} triangles in all, ${counted(recording.steps, 'step', 'steps')} of ${(1000 * recording.dt).toFixed(1)} ms, method ${recording.method}, direction ${recording.direction}.`
  + (motion.stride > 1 ? ` One step of ${motion.stride} is here.` : '')
  + (recording.meshSource ? ` Meshes: ${recording.meshSource}` : '');

function legend(names, by) {
  const depth = layers && by === 'depth' && (names.includes('contacts') || names.includes('rays'));
  const device = layers && by === 'device' && names.length > 0;
  element('legend').hidden = !depth && !device;
  element('legend-bar').hidden = !depth;
  if (depth) {
    element('legend-low').textContent = 'depth 0';
    element('legend-high').textContent = metres(layers.deepest);
    if (layers.most > 1.01 * layers.deepest) {
      const dot = document.createElement('b');
      dot.style.background = css(beyondColour);
      element('legend-high').append(dot, `deeper, up to ${metres(layers.most)} in step ${layers.deepestStep}`);
    }
    element('legend-bar').style.background = `linear-gradient(90deg, ${depthStops.map(css).join()})`;
  } else if (device) {
    element('legend-low').textContent = '';
    element('legend-high').replaceChildren(...recording.layers.devices.flatMap((name, i) => {
      const dot = document.createElement('b');
      dot.style.background = css(deviceColours[i % deviceColours.length]);
      return [dot, name];
    }));
  }
}

async function draw(now) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const names = controls.layerNames(), by = element('colour').value || 'depth';
  let layerStep = null;
  if (layers && names.length) {
    const i = layers.at(controls.step);
    layerStep = layers.steps[i];
    await layers.prepare(i, names, by);
  }
  gl.viewport(0, 0, width, height);
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  gl.clearColor(...(dark ? [0.11, 0.12, 0.14] : [0.9, 0.92, 0.94]), 1);
  gl.enable(gl.DEPTH_TEST);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const toClip = camera.matrix();
  bodies.draw(controls.kept(), controls.kept() * motion.stride, camera, toClip, detail, element('clear').checked);
  const marks = clashes ? clashes.draw(toClip, height * focal, ratio) : layerStep === null ? 0 : layers.draw(toClip, height * focal, ratio);
  if (!clashes) controls.say(recording, layerStep);
  legend(names, by);
  ++frames;
  Object.assign(document.documentElement.dataset, {state: 'ready', frames, step: controls.step, triangles: bodies.triangles, marks, detail: detail.toPrecision(3)});
}

// Less detail where frames follow each other slowly, more where they come fast.
function adapt(interval) {
  if (interval > 70) detail = Math.max(detail * 0.6, 1e-4);
  else if (interval > 45) detail = Math.max(detail * 0.85, 1e-4);
  else if (interval < 28) detail = Math.min(detail * 1.08, 1);
}

async function frame(now) {
  try {
    controls.advance(now, recording.dt);
    if (dirty) {
      dirty = false;
      if (before !== null) adapt(now - before);
      before = now;
      await draw(now);
    } else {
      before = null;
      if (detail < 1 && performance.now() - moved > 400) { // it stands: one picture in full detail, and back
        const moving = detail;
        detail = 1;
        await draw(now);
        detail = moving;
        moved = Infinity;
      }
    }
    requestAnimationFrame(frame);
  } catch (error) {
    fail(error);
  }
}
fit();
if (clashes && element('clash').value) clashes.look(element('clash').value);
requestAnimationFrame(frame);
