// A list of clashes in place of the steps of a recording. The two parts of the one that is chosen are red and blue, all
// others faint; while none is chosen, clashing parts are red and the others faint.
const pairTints = [[0.82, 0.18, 0.14], [0.16, 0.4, 0.85]];

class Clashes extends Marks {
  constructor(gl, recording, bodies, camera, changed) {
    const radii = recording.bodies.map(([shape]) => bodies.shapes[shape].radius);
    super(gl, 0.02 * median(radii), 6);
    Object.assign(this, {recording, bodies, camera, changed, radii});
    this.tints = bodies.list.map(body => body.tint);
    const list = element('clash'), kept = recording.clashes;
    list.add(new Option(`all: ${counted(kept.length, 'clash', 'clashes')}`, ''));
    kept.forEach((clash, i) => list.add(new Option(`${i + 1}. ${clash.name}: ${this.words(clash)}`, i)));
    list.onchange = () => { this.choose(list.value); this.look(list.value); };
    element('clash-label').hidden = false;
    for (const id of ['play', 'back', 'forward', 'time', 'layers']) element(id).hidden = true;
    for (const id of ['colour', 'speed']) element(id).parentNode.hidden = true;
    const words = new URLSearchParams(location.hash.slice(1));
    if (kept[words.get('clash') - 1]) list.value = words.get('clash') - 1;
    this.choose(list.value);
  }

  words(clash) {
    const number = x => String(+x.toPrecision(4));
    return clash.kind + (clash.depth === null ? '' : clash.depth > 0 ? `, ${number(clash.depth)} deep` : clash.depth < 0 ? `, ${number(-clash.depth)} apart` : '');
  }

  choose(value) {
    const all = this.recording.clashes, one = value === '' ? null : all[value], wanted = one ? [one] : all;
    const clashing = new Set(wanted.flatMap(clash => [clash.a, clash.b]));
    this.bodies.list.forEach((body, i) => {
      body.faint = !clashing.has(i);
      body.tint = one && i === one.a ? pairTints[0] : one && i === one.b ? pairTints[1] : this.tints[i];
    });
    this.show([], wanted.flatMap(clash => [...clash.point, 1, 0.85, 0.1, 1]));
    element('said').textContent = one ? `at ${one.at.map(x => +x.toPrecision(7)).join(', ')}` : '';
    this.changed();
  }

  look(value) {
    if (value === '') return element('frame').onclick();
    const {point, a, b} = this.recording.clashes[value];
    this.camera.target = [...point];
    this.camera.distance = 3 * Math.min(this.radii[a], this.radii[b]) * focal;
    this.changed();
  }
}
