// Time and its listeners: play, pause, step, scrub, speed; keys; the chosen body.

const kSpeeds = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];
const byId = id => document.getElementById(id);

class Player {
  constructor(about, runs) {
    this.about = about;
    this.runs = runs;
    this.end = Math.max(...runs.map(run => run.end));
    this.longest = runs.reduce((a, b) => (b.end > a.end ? b : a));
    this.time = 0;
    this.speed = [...kSpeeds].reverse().find(s => s <= 1 && s <= this.end / 3) || kSpeeds[0];   // a short run is played slowly: at least three seconds
    this.isPlaying = false;
    this.chosen = -1;
    this.followed = -1;
    this.listeners = [];   // called with the player whenever something has changed
    this.events = [...new Set(runs.flatMap(run => Array.from(run.events.time)))].sort((a, b) => a - b);
    this.shown = { impulses: true, contacts: true, forces: true, links: true, path: true, halo: true, ground: true, shadows: true, loop: false, beside: false };
  }

  changed() {
    for (const tell of this.listeners) tell(this);
    this.tenth = Math.floor(performance.now() / 100);
  }

  seek(t) {
    this.time = Math.min(this.end, Math.max(0, t));
    this.changed();
  }

  goTo(t) {   // from a list of events or a mark: pauses there
    this.pause();
    this.seek(t);
  }

  play() {
    if (this.time >= this.end - 1e-9) this.time = 0;
    this.isPlaying = true;
    this.last = undefined;
    this.changed();
  }

  pause() {
    this.isPlaying = false;
    this.changed();
  }

  // Whether numbers should be updated: ten times a second while it plays, as fast as they can be
  // read.
  isTimeToTell() {
    return !this.isPlaying || Math.floor(performance.now() / 100) !== this.tenth;
  }

  toggle() { this.isPlaying ? this.pause() : this.play(); }

  step(frames) {
    this.isPlaying = false;
    const times = this.longest.times, at = this.longest.frameAt(this.time), isBetween = at.part > 1e-3 && frames < 0;
    this.seek(times[Math.min(times.length - 1, Math.max(0, at.k + frames + (isBetween ? 1 : 0)))]);
  }

  // Goes to the next or previous event.
  jump(direction) {
    const times = this.events, near = 1e-5;
    const found = direction > 0 ? times.find(t => t > this.time + near) : [...times].reverse().find(t => t < this.time - near);
    if (found !== undefined) this.goTo(found);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.changed();
  }

  faster(steps) {
    const at = kSpeeds.reduce((best, s, i) => (Math.abs(Math.log(s / this.speed)) < Math.abs(Math.log(kSpeeds[best] / this.speed)) ? i : best), 0);
    this.setSpeed(kSpeeds[Math.min(kSpeeds.length - 1, Math.max(0, at + steps))]);
  }

  choose(body) {
    this.chosen = body;
    if (this.followed >= 0) this.followed = body;
    this.changed();
  }

  follow(isOn) {
    this.followed = isOn ? this.chosen : -1;
    this.changed();
  }

  tick(now) {   // [ms]
    if (!this.isPlaying) return;
    const dt = this.last === undefined ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.time += dt * this.speed;
    if (this.time >= this.end) {
      if (this.shown.loop) this.time = 0;
      else { this.time = this.end; this.isPlaying = false; }
    }
    this.changed();
  }
}

// The controls below the picture.
class Controls {
  constructor(player, resetView) {
    this.player = player;
    this.resetView = resetView;
    const click = (id, act) => byId(id).addEventListener('click', act);
    click('play', () => player.toggle());
    click('stepBack', () => player.step(-1));
    click('stepOn', () => player.step(1));
    click('back', () => player.jump(-1));
    click('next', () => player.jump(1));
    click('follow', () => player.follow(player.followed < 0));
    click('home', resetView);
    for (const s of kSpeeds) byId('speed').append(html('option', { value: String(s) }, `${s} ×`));
    byId('speed').addEventListener('change', event => player.setSpeed(Number(event.target.value)));
    byId('body').append(html('option', { value: '-1' }, 'body …'));
    player.about.bodies.forEach((body, i) => byId('body').append(html('option', { value: String(i) }, body.name)));
    byId('body').addEventListener('change', event => player.choose(Number(event.target.value)));
    const scrub = byId('scrub');
    scrub.max = String(player.end);
    scrub.step = String(player.end / 20000);
    scrub.addEventListener('input', () => player.goTo(Number(scrub.value)));
    this.addOptions();
    this.addDifference();
    window.addEventListener('keydown', event => this.key(event));
    new ResizeObserver(() => this.drawMarks()).observe(byId('marks'));
    player.listeners.push(() => this.show());
    this.show();
  }

  addOptions() {
    const hex = color => '#' + color.toString(16).padStart(6, '0');
    const has = { contacts: this.player.runs.some(run => run.head.contacts > 0), forces: this.player.about.forces.length > 0,
      beside: this.player.runs.length > 1, links: this.player.about.springs.length + this.player.about.rods.length + this.player.about.joints.length > 0 };
    const options = [['impulses', 'impulses', kColors.impulse], ['contacts', 'contact points and their forces', kColors.contact], ['forces', 'point forces', kColors.force],
      ['links', 'springs, rods, joints', kColors.rod], ['path', 'path of the chosen body', kColors.path], ['halo', 'chosen body outlined', kChosen], ['ground', 'ground and grid', kLine], ['shadows', 'shadows'], ['beside', 'two views instead of a ghost'], ['loop', 'repeat']];
    for (const [name, text, color] of options) {
      if (has[name] === false) continue;
      const box = html('input', { type: 'checkbox', checked: this.player.shown[name] }), swatch = html('i');
      if (color !== undefined) swatch.style.background = hex(color);
      box.addEventListener('change', () => { this.player.shown[name] = box.checked; this.player.changed(); });
      byId('options').append(html('label', {}, box, swatch, ` ${text}`));
    }
    byId('options').append(html('p', { className: 'keys' }, 'Keys: space play and pause · ← → a frame, with shift ten · ↑ ↓ speed · N P next and previous event · Home End · F follow · R reset the view · drag turn, right drag or two fingers shift, wheel or pinch nearer.'));
  }

  addDifference() {
    const difference = this.player.about.difference;
    if (difference === undefined) return;
    const line = byId('difference'), stopped = this.player.about.stopped, at = difference || stopped;
    line.hidden = false;
    line.querySelector('span').textContent = this.differenceInWords(difference, stopped);
    line.classList.toggle('same', !at);
    line.classList.toggle('stopped', Boolean(stopped && !difference));
    line.querySelector('button').hidden = !at;
    line.querySelector('button').addEventListener('click', () => this.player.goTo(at.time));
  }

  // Three states: they differ, one stopped and they were the same until then, or they are the same.
  differenceInWords(difference, stopped) {
    const ended = stopped && `${this.player.runs[stopped.run].label} stopped at ${short(stopped.time, 6)} s of ${short(stopped.end, 6)} s`;
    if (difference) return `First difference at ${short(difference.time, 6)} s: ${difference.what}.${ended ? ` Later ${ended}.` : ''}`;
    if (!stopped) return 'Both runs are equal to a millionth of the view.';
    return stopped.time > 0 ? `${ended}; both runs are the same until then.` : `${ended}, before anything could differ.`;
  }

  key(event) {
    const inText = event.target instanceof Element && event.target.closest('select, input[type=text]');
    if (inText || event.ctrlKey || event.metaKey || event.altKey) return;
    const player = this.player, onButton = event.target instanceof Element && event.target.closest('button, summary');
    const acts = { ' ': onButton ? null : () => player.toggle(), ArrowRight: () => player.step(event.shiftKey ? 10 : 1), ArrowLeft: () => player.step(event.shiftKey ? -10 : -1),
      ArrowUp: () => player.faster(1), ArrowDown: () => player.faster(-1), Home: () => player.goTo(0), End: () => player.goTo(player.end), n: () => player.jump(1), p: () => player.jump(-1),
      f: () => player.follow(player.followed < 0), r: () => this.resetView() };
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    act();
    event.preventDefault();
  }

  show() {
    const player = this.player;
    byId('scrub').value = String(player.time);
    if (!player.isTimeToTell()) return;
    byId('play').textContent = player.isPlaying ? 'Pause' : 'Play';
    byId('clock').textContent = `${player.time.toFixed(player.end < 1 ? 4 : 3)} s`;
    byId('scrub').setAttribute('aria-valuetext', `${player.time.toFixed(3)} seconds`);
    byId('speed').value = String(player.speed);
    byId('body').value = String(player.chosen);
    byId('follow').disabled = player.chosen < 0;
    byId('back').disabled = byId('next').disabled = player.events.length === 0;
    byId('follow').setAttribute('aria-pressed', String(player.followed >= 0));
  }

  // Marks along the slider: a line for an event, a long one for a collision, a wedge for the first
  // difference and for an early end.
  drawMarks() {
    const canvas = byId('marks'), width = canvas.clientWidth, height = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const g = canvas.getContext('2d'), inset = 8;   // half of the scrubber's thumb
    g.scale(ratio, ratio);
    const x = t => inset + t / this.player.end * (width - 2 * inset), rows = this.player.runs.length;
    this.player.runs.forEach((run, r) => {
      const top = r * height / rows, size = height / rows - 1;
      for (let i = 0; i < run.events.count; ++i) {
        const isCollision = run.events.kind[i] === kCollision, part = isCollision ? 1 : 0.5;
        g.fillStyle = isCollision ? '#c14d00' : '#5b6875';
        g.globalAlpha = run.events.count > 400 ? 0.35 : 0.9;
        g.fillRect(x(run.events.time[i]) - 0.5, top + (1 - part) * size, 1, part * size);
      }
    });
    g.globalAlpha = 1;
    for (const [at, color] of [[this.player.about.stopped, '#8a5a00'], [this.player.about.difference, '#a82c00']]) {
      if (!at) continue;
      g.fillStyle = color;
      g.beginPath();
      g.moveTo(x(at.time), height);
      g.lineTo(x(at.time) - 5, 0);
      g.lineTo(x(at.time) + 5, 0);
      g.fill();
    }
  }
}
