// A task later, with no timer, which browsers round up.
function nextTask() {
  return new Promise((done) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => { port1.close(); done(); };
    port2.postMessage(0);
  });
}

// The C++ behind the page (exports.cpp), as JavaScript sees it.
class Engine {
  static async start(packed) {
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const plain = new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')));
    const module = await thimble({ wasmBinary: await plain.arrayBuffer() });
    return new Engine(module);
  }
  constructor(module) {
    this.m = module;
    this.names = this.text(module._state_names()).split(' ');
    this.onset_ms = 1000 * module._onset_s();  // it reads all settings: once
  }
  text(pointer) { return this.m.UTF8ToString(pointer); }
  lines(pointer) { return this.text(pointer).split('\n').filter((line) => line !== ''); }
  begin(side, { modality, delay, virtual, compensator, seed, network }) {
    this.m._begin_trial(side, modality, delay, virtual ? 1 : 0, compensator, seed);
    if (network) this.m.ccall('change_network', 'number', ['number', 'string'], [side, network]);
  }
  changeDelay(side, delay) { this.m._change_delay(side, delay); }
  advance(side, seconds, hand, engaged) {
    const at = this.m._advance(side, seconds, hand, engaged ? 1 : 0) / 8;
    return Object.fromEntries(this.names.map((name, i) => [name, this.m.HEAPF64[at + i]]));
  }
  draw(side, width, height, wallSeen, share) { this.m._draw(side, width, height, wallSeen ? 1 : 0, share); }
  // What a gamepad's motors have to do now; nothing if they do it already.
  rumble(side, now) {
    const at = this.m._rumble(side, now) / 8;
    return at ? { strongMagnitude: this.m.HEAPF64[at], weakMagnitude: this.m.HEAPF64[at + 1], duration: 1000 * this.m._rumble_lasts_s() } : null;
  }
  drawnNeedle(side) { return this.m._drawn_needle_m(side); }
  show(side, values) { this.m._show_sample(side, ...values); }
  pixelsPerMetre(height) { return this.m._pixels_per_metre(height); }
  vertices(side) { return this.m.HEAPU8.subarray(this.m._vertices(side), this.m._vertices(side) + this.m._vertex_bytes(side)); }
  indices(side) { return this.m.HEAPU8.subarray(this.m._indices(side), this.m._indices(side) + 4 * this.m._index_count(side)); }
  indexCount(side) { return this.m._index_count(side); }
  labels(side) {
    return this.lines(this.m._labels(side)).map((line) => {
      const [x, y, r, g, b, endsThere, ...words] = line.split(' ');
      return { x: +x, y: +y, colour: `rgb(${r},${g},${b})`, endsThere: endsThere === '1', text: words.join(' ') };
    });
  }
  networks() { return this.lines(this.m._networks()).map((line) => line.split('\t')); }
  compensators() { return this.lines(this.m._compensators()); }

  // One after the other: the C++ has one study at a time.
  alone(work) {
    const turn = (this.turn ?? Promise.resolve()).then(work);
    this.turn = turn.catch(() => {});
    return turn;
  }
  study(...choice) { return this.alone(() => this.runStudy(...choice)); }
  // Experiment 3, in slices that leave the page time to draw.
  async runStudy(seed, subjects, tell) {
    this.m._begin_study(seed, subjects);
    const start = performance.now();
    for (let more = true; more;) {
      const slice = performance.now();
      while (more && performance.now() - slice < 30) more = this.m._go_on_study(500) !== 0;
      const wall = (performance.now() - start) / 1000;
      if (tell) tell(this.m._study_done(), this.m._study_planned(), this.m._study_simulated_s() / wall);
      await nextTask();
    }
    return Array.from({ length: this.m._study_done() }, (_, row) => {
      const [modality, mean, max, time, shakes, subject] = [0, 1, 2, 3, 4, 5].map((column) => this.m._study_value(row, column));
      return { modality, mean, max, time, shakes, subject };
    });
  }
  digest(seed) { return this.alone(() => this.digestOf(seed)); }
  async digestOf(seed) {
    if (!crypto.subtle) throw new Error(say('digest_secure'));
    await this.runStudy(seed, 1);
    this.m.ccall('write_study', null, ['string'], ['/trials.csv']);
    const hash = new Uint8Array(await crypto.subtle.digest('SHA-256', this.m.FS.readFile('/trials.csv')));
    return Array.from(hash, (byte) => byte.toString(16).padStart(2, '0')).join('');
  }
}
