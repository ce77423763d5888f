// The page: what a visitor does goes to the engine, what the engine knows goes on the screen.
const MODALITIES = ['HF', 'CF', 'CCF', 'VF'];
const SIDE = { main: 0, hand: 1, finger: 2, replay: 3 };
const FARTHEST_m = [-0.05, 0.0667];  // of the hand: the needle goes three times as far
const KEY_m_per_s = 0.02;
const STICK_m_per_s = 0.05, STICK_DEAD = 0.15;  // as at the window of thimble play
const PEAK_ms = 500;  // the figures show the most of so long, or none could be read
const CALM_s = 0.6, CALM_PLOT_ms = 1000;  // where a visitor asked for reduced motion
const $ = (id) => document.getElementById(id);

class Page {
  constructor(engine) {
    this.engine = engine;
    this.choice = { modality: 0, delay: 0.05, virtual: false, compensator: 0, seed: 1, network: '' };
    this.hand = { position: 0, engaged: false, key: 0 };
    this.beside = false;
    this.hint = { key: '', since: 0 };
    this.beeps = 0;
    this.calm = matchMedia('(prefers-reduced-motion: reduce)');
    this.views = [0, 1, 2, 3].map((side) => new SceneView(engine, side, $(`scene-${side}`), () => this.redraw()));
    this.strip = new Strip($('plot'), 6);
    this.fillIn();
    this.listen();
    this.restart();
    sayAll();
    this.sayRest();
    requestAnimationFrame((now) => { this.last = now; this.frame(now); });
  }

  fillIn() {
    for (const [i, name] of MODALITIES.entries()) {
      const button = document.createElement('button');
      button.dataset.words = name;
      button.addEventListener('click', () => this.choose({ modality: i }));
      $('modalities').append(button);
    }
    $('network').append(new Option('', ''));
    $('network').options[0].dataset.words = 'own';
    for (const [name, words] of this.engine.networks()) {
      const option = new Option('', name);
      option.dataset.plain = words;
      $('network').append(option);
    }
    for (const [i, name] of this.engine.compensators().entries()) $('compensator').append(new Option(name, i));
    $('compensator').options[0].dataset.words = 'none';
    $('onset-mark').append(new Option('', Math.round(this.engine.onset_ms)));
    $('language').value = language;
  }

  listen() {
    $('language').addEventListener('change', () => { language = $('language').value; sayAll(); this.sayRest(); this.redraw(); });
    $('delay').addEventListener('input', () => this.changeDelay($('delay').value / 1000));
    $('virtual').addEventListener('change', () => this.choose({ virtual: $('virtual').checked }));
    $('network').addEventListener('change', () => this.choose({ network: $('network').value }));
    $('compensator').addEventListener('change', () => this.choose({ compensator: +$('compensator').value }));
    $('again').addEventListener('click', () => this.restart());
    $('beside').addEventListener('click', () => { this.beside = !this.beside; $('beside').setAttribute('aria-pressed', this.beside); this.restart(); });
    addEventListener('resize', () => this.redraw());
    $('wall').addEventListener('change', () => this.redraw());
    $('sound').addEventListener('change', () => this.wake());  // a gamepad and a virtual subject press nothing
    $('study').addEventListener('click', () => this.runStudy());
    $('digest').addEventListener('click', () => this.showDigest());
    this.holdBy($('scene-0').querySelector('.grip'));
    for (const side of [1, 2]) this.holdBy($(`scene-${side}`));
    this.replay = new Replay(this.engine, this.views[SIDE.replay], this.calm);
  }

  // Press, drag, let go; or the arrow keys.
  holdBy(place) {
    place.style.touchAction = 'none';
    place.addEventListener('pointerdown', (event) => {
      if (!event.isPrimary) return;  // a second finger
      place.setPointerCapture(event.pointerId);
      this.hand.engaged = true;
      this.hand.position = this.state.needle_m / 3;
      this.hand.y = event.clientY;
      this.wake();
    });
    place.addEventListener('pointermove', (event) => {
      if (!event.isPrimary || !this.hand.engaged || this.hand.y === undefined) return;
      const per_m = this.engine.pixelsPerMetre(place.clientHeight);
      this.moveHand((event.clientY - this.hand.y) / per_m / 3);
      this.hand.y = event.clientY;
    });
    for (const name of ['pointerup', 'pointercancel'])
      place.addEventListener(name, (event) => { if (event.isPrimary) { this.hand.engaged = false; this.hand.y = undefined; } });
    place.addEventListener('keydown', (event) => this.key(event, event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0));
    place.addEventListener('keyup', () => { this.hand.key = 0; });
    place.addEventListener('blur', () => { this.hand.key = 0; this.hand.engaged = this.hand.y !== undefined; });
  }
  key(event, direction) {
    if (direction === 0) return;
    event.preventDefault();
    if (!this.hand.engaged) this.hand.position = this.state.needle_m / 3;
    this.hand.engaged = true;
    this.hand.key = direction;
    this.wake();
  }
  // Held by A and pushed by the left stick. Its motors are the belts of CF and CCF, where the browser moves motors.
  usePad(now, seconds) {
    const pad = [...(navigator.getGamepads?.() ?? [])].find((one) => one);
    const held = Boolean(pad?.buttons[0]?.pressed);
    if (held !== Boolean(this.padHeld)) {
      this.hand.engaged = this.padHeld = held;
      if (held) this.hand.position = this.state.needle_m / 3;
    }
    const stick = held ? pad.axes[1] : 0;
    if (Math.abs(stick) > STICK_DEAD) this.moveHand(stick * STICK_m_per_s * seconds);
    const motors = pad?.vibrationActuator && this.engine.rumble(SIDE.main, now / 1000);
    if (motors) pad.vibrationActuator.playEffect('dual-rumble', motors).catch(() => {});
  }
  moveHand(way) { this.hand.position = Math.min(Math.max(this.hand.position + way, FARTHEST_m[0]), FARTHEST_m[1]); }
  wake() { if ($('sound').checked && !this.audio) this.audio = new AudioContext(); }

  choose(change) {
    Object.assign(this.choice, change);
    this.restart();
    this.sayRest();
  }
  changeDelay(delay) {
    this.choice.delay = delay;
    for (const side of this.sides()) this.engine.changeDelay(side, delay);
    if (this.choice.network) this.choose({ network: $('network').value = '' });
    this.sayRest();
  }
  sides() { return this.beside ? [SIDE.main, SIDE.hand, SIDE.finger] : [SIDE.main]; }
  restart() {
    this.engine.begin(SIDE.main, this.choice);
    for (const [side, modality] of [[SIDE.hand, 0], [SIDE.finger, 1]]) {
      this.engine.begin(side, { ...this.choice, modality });
      this.engine.advance(side, 0.001, 0, false);
    }
    this.rested = false;  // the two needles are drawn once, also while nobody pushes them
    this.hand.position = 0;
    this.beeps = 0;
    this.state = this.engine.advance(SIDE.main, 0.001, 0, false);
  }
  // What is not drawn in every frame.
  redraw() {
    this.rested = false;
    if (this.replay?.rows.length) this.replay.show();
  }
  sayRest() {
    const delay_ms = Math.round(1000 * (this.choice.network ? this.state.delay_s : this.choice.delay));
    $('delay-text').textContent = `${delay_ms} ms`;
    $('delay').value = delay_ms;
    $('onset').textContent = say('onset', this.engine.onset_ms.toFixed(1));
    $('plot').setAttribute('aria-label', say('plot'));
    document.querySelector('.grip').setAttribute('aria-label', say('grip'));
    document.querySelector('.flash').textContent = say('beep');
    for (const [i, button] of [...$('modalities').children].entries()) button.setAttribute('aria-pressed', i === this.choice.modality);
    this.hint.key = '';
  }

  frame(now) {
    const seconds = Math.min((now - this.last) / 1000, 0.05);
    this.last = now;
    this.moveHand(this.hand.key * KEY_m_per_s * seconds);
    this.usePad(now, seconds);
    const share = this.calm.matches ? 1 - Math.exp(-seconds / CALM_s) : 1;
    for (const side of this.sides()) {
      const state = this.engine.advance(side, seconds, this.hand.position, this.hand.engaged);
      if (side === SIDE.main) this.state = state;
      this.views[side].draw($('wall').checked, share);
    }
    if (!this.rested && !this.beside) for (const side of [SIDE.hand, SIDE.finger]) this.views[side].draw($('wall').checked);
    this.rested = true;
    this.replay.frame(seconds);
    this.strip.add(this.state.time_s, this.state.needle_m, this.state.fixture_m);
    if (!this.calm.matches || now - (this.plotted ?? 0) >= CALM_PLOT_ms) {
      this.strip.draw();
      this.plotted = now;
    }
    this.tell(now);
    requestAnimationFrame((next) => this.frame(next));
  }

  tell(now) {
    const s = this.state, beyond = this.most('beyond', now, 1000 * (s.needle_m - s.fixture_m));
    const values = [['depth', beyond > 0 ? `${beyond.toFixed(1)} ${say('unit_mm')}` : '–'], ['force', `${this.most('force', now, Math.abs(s.force_total_N)).toFixed(1)} ${say('unit_N')}`],
      ['lost', s.contacts_lost], ['frequency', `${s.frequency_Hz.toFixed(1)} ${say('unit_Hz')}`],
      [s.energy_in_J < -0.01 ? 'energy_bad' : 'energy', `${s.energy_in_J.toFixed(2)} ${say('unit_J')}`]];
    const figures = $('figures');
    while (figures.children.length < values.length) {
      const box = document.createElement('div');
      box.append(document.createElement('dt'), document.createElement('dd'));
      figures.append(box);
    }
    values.forEach(([key, value], i) => {
      const [name, shown] = figures.children[i].children;
      name.textContent = say(key);
      shown.textContent = value;
      figures.children[i].classList.toggle('bad', key === 'energy_bad');
    });
    document.querySelector('.grip').setAttribute('aria-valuenow', Math.round(1000 * this.engine.drawnNeedle(SIDE.main)));
    if (s.beeps > this.beeps) this.beep();
    this.beeps = s.beeps;
    this.giveHint(now);
  }
  most(name, now, value) {
    const seen = ((this.seen ??= {})[name] ??= []);
    seen.push([now, value]);
    while (seen[0][0] < now - PEAK_ms) seen.shift();
    return Math.max(...seen.map(([, one]) => one));
  }
  // One sentence, which stays for a while even if the needle shakes.
  giveHint(now) {
    const s = this.state;
    if (s.frequency_Hz >= 1.5) this.shookAt = now;
    let key = 'hint_start';
    if (this.choice.virtual) key = 'hint_watch';
    if (s.beeps > 0 && s.needle_m > s.fixture_m - 0.02) key = 'hint_out';
    else if (now - (this.shookAt ?? -1e9) < 1500) key = 'hint_shake';
    else if (s.hold_s > 0) key = 'hint_hold';
    else if (this.hand.engaged && !this.choice.virtual) key = 'hint_in';
    if (key === this.hint.key || (this.hint.key !== '' && now - this.hint.since < 1200)) return;
    this.hint = { key, since: now };
    $('hint').textContent = say(key) + (key === 'hint_start' ? say('hint_key') : '');
  }
  beep() {
    const flash = document.querySelector('.flash');
    flash.hidden = false;
    setTimeout(() => { flash.hidden = true; }, 1200);
    if (!this.audio || !$('sound').checked) return;
    const tone = new OscillatorNode(this.audio, { frequency: 880 });
    tone.connect(this.audio.destination);
    tone.start();
    tone.stop(this.audio.currentTime + 0.25);
  }

  async runStudy() {
    $('study').disabled = true;
    const rows = await this.engine.study(1, 10, (done, all, speed) => { $('study-state').textContent = say('study_state', done, all, Math.round(speed)); });
    $('study').disabled = false;
    const shaking = (some) => some.filter((row) => row.shakes).length;
    const hand = rows.filter((row) => row.modality === 0), others = rows.filter((row) => row.modality !== 0);
    $('study-state').textContent = say('study_shakes', shaking(hand), hand.length, shaking(others), others.length);
    $('bars').replaceChildren(...[['mean', 1000], ['max', 1000], ['time', 1]].map(([measure, scale]) => bars(rows, measure, scale)));
  }
  async showDigest() {
    const seed = Math.max(1, Math.round(+$('seed').value || 1));
    $('digest-text').textContent = say('digest_wait');
    let digest = '';
    try { digest = await this.engine.digest(seed); } catch (error) { $('digest-text').textContent = error.message; return; }
    $('digest-text').textContent = `${digest}\n\nthimble study --experiment 3 --subjects 1 --no-control --seed ${seed} --out out/seed${seed}\nsha256sum out/seed${seed}/trials.csv`;
  }
}

// Mean and standard deviation over subjects, in the paper's order.
function bars(rows, measure, scale) {
  const order = [3, 0, 1, 2], height = 150;
  const values = order.map((modality) => {
    const of = [...new Set(rows.map((row) => row.subject))].map((subject) => {
      const mine = rows.filter((row) => row.subject === subject && row.modality === modality && Number.isFinite(row[measure]));
      return scale * mine.reduce((sum, row) => sum + row[measure], 0) / mine.length;
    }).filter(Number.isFinite);
    const mean = of.reduce((a, b) => a + b, 0) / of.length;
    return { mean, sd: Math.sqrt(of.reduce((sum, v) => sum + (v - mean) ** 2, 0) / Math.max(1, of.length - 1)) };
  });
  const top = Math.max(...values.map((v) => v.mean + v.sd)), y = (v) => height - (height - 30) * v / top;
  const shapes = values.map(({ mean, sd }, i) => {
    const x = 20 + 55 * i;
    return `<rect x="${x}" y="${y(mean)}" width="36" height="${height - y(mean)}" fill="#56b4e9"/>
      <path d="M${x + 18} ${y(Math.max(0, mean - sd))}V${y(mean + sd)}" stroke="#fff" stroke-width="2"/>
      <text x="${x + 18}" y="${height + 15}" text-anchor="middle">${MODALITIES[order[i]]}</text>
      <text x="${x + 40}" y="${y(mean) - 3}" text-anchor="middle" font-size="11">${mean.toFixed(1)}</text>`;
  });
  const figure = document.createElement('figure');
  figure.style.margin = 0;
  figure.innerHTML = `<svg viewBox="0 0 240 172" role="img" aria-label="${say(`bar_${measure}`)}" font-size="13" fill="#eef1f5">
    <text x="4" y="14">${say(`bar_${measure}`)}</text>${shapes.join('')}</svg>`;
  return figure;
}
