// The buttons below the picture; and the address after #, which can name a moment: #step=120&layers=rays,hits&colour=device&clear&play
class Controls {
  constructor(recording, motion, changed) {
    this.step = 0; this.playing = false; this.last = recording.steps - 1; this.stride = motion.stride;
    this.changed = changed;
    this.shown = [];
    const time = element('time');
    time.max = motion.kept - 1;
    time.addEventListener('input', () => { this.pause(); this.seek(time.value * this.stride); });
    element('play').onclick = () => this.playing ? this.pause() : this.play();
    element('back').onclick = () => { this.pause(); this.seek(this.kept() * this.stride - this.stride); };
    element('forward').onclick = () => { this.pause(); this.seek((this.kept() + 1) * this.stride); };
    document.addEventListener('keydown', e => {
      if (['SELECT', 'BUTTON', 'INPUT'].includes(e.target.tagName)) return;
      const button = {' ': 'play', ArrowLeft: 'back', ArrowRight: 'forward'}[e.key];
      if (button) { e.preventDefault(); element(button).click(); }
    });
    this.addLayers(recording.layers);
    for (const id of ['colour', 'clear', 'speed']) element(id).addEventListener('change', () => this.changed());
    this.readAddress();
    if (framed) matchMedia('(prefers-reduced-motion: reduce)').matches ? this.seek(this.last) : this.play(); // a report shows the run
    window.addEventListener('hashchange', () => this.readAddress());
  }

  addLayers(layers) {
    const row = element('layers');
    if (!layers) { element('colour').parentNode.hidden = true; return; }
    for (const [name, meaning] of Object.entries(layerNames)) {
      const label = document.createElement('label'), box = document.createElement('input');
      const some = layers.steps.some(s => name === 'predictions' ? s.predictions : s.contacts);
      box.type = 'checkbox'; box.id = 'layer-' + name; box.disabled = !some;
      if (!some) label.dataset.off = '';
      label.title = some ? meaning : meaning + ' - this view has none';
      label.append(box, ' ' + name[0].toUpperCase() + name.slice(1));
      row.append(label, ' ');
      box.onchange = () => this.changed();
    }
    for (const by of layers.devices.length > 1 ? ['depth', 'device'] : ['depth']) element('colour').add(new Option('by ' + by, by));
    if (layers.devices.length === 1) element('colour').parentNode.hidden = true;
  }

  readAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    if (words.has('step')) this.seek(Number(words.get('step')) || 0);
    if (words.has('layers')) for (const name of words.get('layers').split(',')) {
      const box = element('layer-' + name);
      if (box && !box.disabled) box.checked = true;
    }
    if (words.has('colour')) element('colour').value = words.get('colour');
    if (words.has('clear')) element('clear').checked = true;
    if (words.has('play')) this.play();
    this.changed();
  }

  kept() { return Math.floor(this.step / this.stride); }
  layerNames() { return Object.keys(layerNames).filter(name => element('layer-' + name)?.checked); }

  seek(step) {
    this.step = Math.max(0, Math.min(this.last, Math.floor(step)));
    element('time').value = this.kept();
    this.changed();
  }

  play() {
    if (this.step >= this.last - this.stride + 1) this.seek(0);
    this.playing = true; this.started = null;
    element('play').textContent = 'Pause';
    this.changed();
  }

  pause() {
    this.playing = false;
    element('play').textContent = 'Play';
    this.changed();
  }

  // In real time: the step that is due now, whatever was drawn in between.
  advance(now, dt) {
    if (!this.playing) return;
    const speed = Number(element('speed').value);
    if (this.started === null || this.speed !== speed) { this.started = now; this.from = this.step; this.speed = speed; }
    const due = this.from + Math.floor((now - this.started) / 1000 * speed / dt);
    if (due >= this.last) this.pause();
    this.seek(due);
  }

  say(recording, layerStep) {
    const kept = this.kept() * this.stride, layers = recording.layers;
    let text = `step ${kept} of ${recording.steps} · ${(kept * recording.dt).toFixed(2)} s`;
    if (layers) text += ` · ${counted(layers.pairs[kept], 'pair', 'pairs')} · ${counted(layers.contacts[kept], 'contact', 'contacts')}` + (layers.contacts[kept] ? `, the deepest ${metres(layers.depths[kept])}` : '');
    if (layerStep !== null && layerStep !== kept) text += ` · layers of step ${layerStep}`;
    element('said').textContent = text;
  }
}
