// A recorded trial (trajectories/*.csv), with a place and a speed.
class Replay {
  static columns = ['time_s', 'position_needle_m', 'position_surface_m', 'force_tissue_N', 'force_fixture_N'];
  constructor(engine, view, calm) {
    Object.assign(this, { engine, view, calm, rows: [], time: 0, playing: false });
    $('file').addEventListener('change', () => $('file').files[0] && this.open($('file').files[0]));
    $('drop').addEventListener('dragover', (event) => event.preventDefault());
    $('drop').addEventListener('drop', (event) => { event.preventDefault(); if (event.dataTransfer.files[0]) this.open(event.dataTransfer.files[0]); });
    $('place').addEventListener('input', () => { this.time = +$('place').value * this.end(); this.show(); });
    $('play').addEventListener('click', () => { this.playing = !this.playing; if (this.time >= this.end()) this.time = 0; });
  }
  async open(file) {
    const lines = (await file.text()).split(/\r?\n/).filter((line) => line !== '' && !line.startsWith('#'));
    const names = (lines[0] || '').split(','), missing = Replay.columns.filter((name) => !names.includes(name));
    $('replay').hidden = missing.length > 0;
    $('replay-error').textContent = missing.length ? say('replay_error', missing.join(', ')) : '';
    if (missing.length) return;
    const at = Replay.columns.map((name) => names.indexOf(name)), phase = names.indexOf('tissue_phase'), wall = names.indexOf('fixture_present');
    this.rows = lines.slice(1).map((line) => line.split(',')).map((cells) => [...at.map((i) => +cells[i]), cells[phase] === 'penetrated' ? 2 : cells[phase] === 'contact' ? 1 : 0, wall < 0 ? 1 : +cells[wall]])
      .filter((row) => row.every(Number.isFinite));
    if (!this.rows.length) { $('replay').hidden = true; $('replay-error').textContent = say('replay_empty'); return; }
    const touched = this.rows.find((row) => row[4] !== 0);
    this.wall = touched ? touched[1] : NaN;
    this.modality = Math.max(0, MODALITIES.findIndex((name) => new RegExp(`(^|_)${name}(_|\\.)`).test(file.name)));
    this.time = 0;
    this.playing = !this.calm.matches;
    this.show();
  }
  end() { return this.rows.length ? this.rows[this.rows.length - 1][0] : 0; }
  frame(seconds) {
    if (!this.playing || !this.rows.length) return;
    this.time = Math.min(this.time + seconds * +$('speed').value, this.end());
    this.playing = this.time < this.end();
    $('place').value = this.time / Math.max(this.end(), 1e-9);
    this.show();
  }
  show() {
    let low = 0, high = this.rows.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (this.rows[middle][0] <= this.time) low = middle; else high = middle - 1; }
    const [, needle, surface, tissue, fixture, phase, present] = this.rows[low], rest = this.rows[0][2];
    this.engine.show(this.view.side, [needle, surface, present ? this.wall : NaN, tissue, fixture, phase, this.modality, rest]);
    this.view.draw($('wall').checked);
    $('place-text').textContent = `${this.time.toFixed(2)} s`;
  }
}
