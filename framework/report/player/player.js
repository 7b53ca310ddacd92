// Time and its listeners: play, pause, step, scrub, speed; keys; the chosen body.

const kSpeeds = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8];
const kFewestFrames = 4;   // in the shown part of time
const kShortest = 1e-3;   // s: the length of time that is shown of a run of one frame

// Speeds to choose from, down to one at which a run takes three seconds: 1, 2, 5 times a power of ten.
function speedsFor(end) {
  const speeds = [...kSpeeds], parts = [2, 2.5, 2];
  for (let k = 0; speeds[0] > end / 3 && k < 60; ++k) speeds.unshift(Number((speeds[0] / parts[k % 3]).toPrecision(1)));
  return speeds;
}

// Digits behind the point of a time [s] in a run that ends then.
function decimalsOf(end) { return end >= 1 ? 3 : Math.min(12, 3 + Math.ceil(-Math.log10(end))); }

const byId = id => document.getElementById(id);

class Player {
  constructor(about, runs) {
    this.about = about;
    this.runs = runs;
    this.end = Math.max(0, ...runs.map(run => run.end)) || kShortest;
    this.longest = runs.reduce((a, b) => (b.end > a.end ? b : a));
    this.time = 0;
    this.from = 0;   // the part of time that slider and curves show
    this.until = this.end;
    this.speeds = speedsFor(this.end);
    this.speed = [...this.speeds].reverse().find(s => s <= 1 && s <= this.end / 3) || this.speeds[0];   // a short run is played slowly: at least three seconds
    this.isPlaying = false;
    this.chosen = -1;
    this.followed = -1;
    this.listeners = [];   // called with the player whenever something has changed
    this.events = [...new Set(runs.flatMap(run => Array.from(run.events.time)))].sort((a, b) => a - b);
    this.shown = { impulses: true, contacts: true, forces: true, links: true, path: true, halo: true, ground: true, shadows: true, triad: true, xray: false, wires: false, loop: false, beside: false };
  }

  changed() {
    this.keepInWindow();
    for (const tell of this.listeners) tell(this);
    this.tenth = Math.floor(performance.now() / 100);
  }

  get isZoomed() { return this.until - this.from < this.end * (1 - 1e-9); }

  // Shows `factor` times as much time, and t where it was. @param factor  Infinity: all of it
  zoom(factor, t = this.time) {
    const shown = this.until - this.from, least = Math.min(this.end, kFewestFrames * this.end / Math.max(1, this.longest.times.length - 1));
    const size = Math.min(this.end, Math.max(least, factor * shown)), from = t - (t - this.from) / shown * size;
    this.from = Math.min(this.end - size, Math.max(0, Number.isFinite(from) ? from : 0));
    this.until = this.from + size;
    if (this.time < this.from || this.time > this.until) this.time = Math.min(this.until, Math.max(this.from, this.time));
    this.changed();
  }

  // The shown part moves on with the time.
  keepInWindow() {
    const size = this.until - this.from;
    if (this.time >= this.from && this.time <= this.until) return;
    this.until = this.time > this.until ? Math.min(this.end, this.time + 0.8 * size) : Math.max(size, this.time + 0.2 * size);
    this.from = this.until - size;
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
    let k = Math.min(times.length - 1, Math.max(0, at.k + frames + (isBetween ? 1 : 0)));
    while (frames < 0 && k > 0 && times[k] > this.time - sameInstant(times)) --k;   // nearer frames count as the same instant
    this.seek(times[k]);
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
    const speeds = this.speeds, at = speeds.reduce((best, s, i) => (Math.abs(Math.log(s / this.speed)) < Math.abs(Math.log(speeds[best] / this.speed)) ? i : best), 0);
    this.setSpeed(speeds[Math.min(speeds.length - 1, Math.max(0, at + steps))]);
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

const kInset = 8;   // half of the slider's thumb [px]

// The controls below the picture.
class Controls {
  // @param picture  null where nothing can be drawn  @param find()  shows the list of bodies
  constructor(player, picture, find) {
    this.player = player;
    this.picture = picture;
    this.find = find;
    const click = (id, act) => byId(id).addEventListener('click', act);
    click('play', () => player.toggle());
    click('stepBack', () => player.step(-1));
    click('stepOn', () => player.step(1));
    click('back', () => player.jump(-1));
    click('next', () => player.jump(1));
    click('follow', () => player.follow(player.followed < 0));
    click('home', () => picture && picture.reset());
    click('nearer', () => player.zoom(0.5));
    click('farther', () => player.zoom(2));
    byId('looks').append(html('option', { value: '' }, 'view …'), ...Object.entries(kLooks).map(([name, look]) => html('option', { value: name }, look.text)));
    byId('looks').addEventListener('change', event => { if (picture && event.target.value) picture.look(event.target.value); event.target.value = ''; });
    for (const s of player.speeds) byId('speed').append(html('option', { value: String(s) }, `${s} ×`));
    byId('speed').addEventListener('change', event => player.setSpeed(Number(event.target.value)));
    byId('body').append(html('option', { value: '-1' }, 'body …'));
    player.about.bodies.forEach((body, i) => byId('body').append(html('option', { value: String(i) }, body.name)));
    byId('body').addEventListener('change', event => player.choose(Number(event.target.value)));
    const scrub = byId('scrub');
    byId('line').addEventListener('wheel', event => { event.preventDefault(); player.zoom(zoomOf(event), this.timeAt(event)); }, { passive: false });
    byId('line').addEventListener('dblclick', () => player.zoom(Infinity));
    scrub.addEventListener('input', () => player.goTo(Number(scrub.value)));
    this.addOptions();
    this.addSavingAndKeys();
    this.addDifference();
    window.addEventListener('keydown', event => this.key(event));
    document.addEventListener('pointerdown', event => { if (!byId('player').contains(event.target) && getComputedStyle(byId('options')).position === 'absolute') byId('more').open = false; });
    new ResizeObserver(() => this.drawMarks()).observe(byId('marks'));
    player.listeners.push(() => this.show());
    this.show();
  }

  addOptions() {
    const hex = color => '#' + color.toString(16).padStart(6, '0');
    const has = { contacts: this.player.runs.some(run => run.head.contacts > 0), forces: this.player.about.forces.length > 0,
      beside: this.player.runs.length > 1, links: this.player.about.springs.length + this.player.about.rods.length + this.player.about.joints.length > 0 };
    const options = [['impulses', 'impulses', kColors.impulse], ['contacts', 'contact points and their forces', kColors.contact], ['forces', 'point forces', kColors.force],
      ['links', 'springs, rods, joints', kColors.rod], ['path', 'path of the chosen body', kColors.path], ['halo', 'chosen body outlined', kChosen], ['ground', 'ground and grid', kLine], ['shadows', 'shadows'], ['triad', 'directions of x, y, z'], ['xray', 'bodies that one sees through'], ['wires', 'edges of the triangles only'], ['beside', 'two views instead of a ghost'], ['loop', 'repeat']];
    for (const [name, text, color] of options) {
      if (has[name] === false) continue;
      const box = html('input', { type: 'checkbox', checked: this.player.shown[name] }), swatch = html('i');
      if (color !== undefined) swatch.style.background = hex(color);
      box.addEventListener('change', () => { this.player.shown[name] = box.checked; this.player.changed(); });
      byId('options').append(html('label', {}, box, swatch, ` ${text}`));
    }
  }

  addSavingAndKeys() {
    const box = html('p', { className: 'saving' }, 'Save ');
    const add = (text, title, act) => {
      const button = html('button', { title }, text);
      button.addEventListener('click', () => act(button));
      box.append(button);
    };
    if (this.picture) {
      add('PNG', 'The picture as it is', () => savePicture(this.player, this.picture));
      if (canRecord()) add('WebM', 'A video of the shown part of time, at the chosen speed', button => recordVideo(this.player, this.picture, button));
      add('glTF', 'Bodies and their motion, for Blender and others', () => saveGltf(this.player, this.picture));
    }
    add('CSV', 'All curves; of a chosen body its motion, too', () => saveTable(this.player));
    byId('options').append(box);
    byId('options').append(html('p', { className: 'keys' }, 'Keys: space play and pause · ← → a frame, with shift ten · ↑ ↓ speed · N P next and previous event · Home End · + − more and less of the time, or the wheel on the slider, and with the control key on a curve; double click: all of it · F follow · / find a body · 1 to 6 views, R that of the scene · drag turn, right drag or two fingers shift, wheel or pinch nearer.'));
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
    if (event.key === 'Escape' && byId('more').open) { byId('more').open = false; byId('more').querySelector('summary').focus(); }
    const inText = event.target instanceof Element && event.target.closest('select, input[type=text], input[type=search]');
    if (inText || event.ctrlKey || event.metaKey || event.altKey) return;
    const player = this.player, at = event.target instanceof Element ? event.target : document.body, onButton = at.closest('button, summary, input[type=checkbox]'), inPane = at.closest('#panes, #options'), names = Object.keys(kLooks);
    const acts = { ' ': onButton ? null : () => player.toggle(), ArrowRight: () => player.step(event.shiftKey ? 10 : 1), ArrowLeft: () => player.step(event.shiftKey ? -10 : -1),
      ArrowUp: () => player.faster(1), ArrowDown: () => player.faster(-1), Home: () => player.goTo(0), End: () => player.goTo(player.end), n: () => player.jump(1), p: () => player.jump(-1),
      f: () => player.follow(player.followed < 0), r: () => this.picture && this.picture.reset(), '+': () => player.zoom(0.5), '-': () => player.zoom(2), '/': () => this.find() };
    names.forEach((name, i) => { if (i < 6) acts[String(i + 1)] = () => this.picture && this.picture.look(name); });
    if (inPane) for (const key of ['ArrowUp', 'ArrowDown', 'Home', 'End']) delete acts[key];   // these scroll it
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    act();
    event.preventDefault();
  }

  show() {
    const player = this.player, scrub = byId('scrub'), shown = `${player.from} ${player.until}`;
    if (shown !== this.shown) {
      this.shown = shown;
      Object.assign(scrub, { min: String(player.from), max: String(player.until), step: String((player.until - player.from) / 20000) });
      byId('window').textContent = player.isZoomed ? `${short(player.from, 5)} to ${short(player.until, 5)} of ${short(player.end, 5)} s` : '';
      byId('farther').disabled = !player.isZoomed;
      this.drawMarks();
    }
    scrub.value = String(player.time);
    if (!player.isTimeToTell()) return;
    byId('play').textContent = player.isPlaying ? 'Pause' : 'Play';
    byId('clock').textContent = `${player.time.toFixed(decimalsOf(player.end))} s`;
    byId('scrub').setAttribute('aria-valuetext', `${player.time.toFixed(decimalsOf(player.end))} seconds`);
    byId('speed').value = String(player.speed);
    byId('body').value = String(player.chosen);
    byId('follow').disabled = player.chosen < 0;
    byId('back').disabled = byId('next').disabled = player.events.length === 0;
    byId('follow').setAttribute('aria-pressed', String(player.followed >= 0));
  }

  timeAt(event) {
    const box = byId('marks').getBoundingClientRect(), share = (event.clientX - box.left - kInset) / (box.width - 2 * kInset);
    return this.player.from + Math.min(1, Math.max(0, share)) * (this.player.until - this.player.from);
  }

  // Marks along the slider: a line for an event, a long one for a collision, a wedge for the first
  // difference and for an early end.
  drawMarks() {
    const canvas = byId('marks'), width = canvas.clientWidth, height = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const g = canvas.getContext('2d'), { from, until } = this.player;
    g.scale(ratio, ratio);
    const x = t => kInset + (t - from) / (until - from) * (width - 2 * kInset), rows = this.player.runs.length;
    this.player.runs.forEach((run, r) => {
      const top = r * height / rows, size = height / rows - 1;
      for (let i = run.eventFrom(from); i < run.events.count && run.events.time[i] <= until; ++i) {
        const isCollision = run.events.kind[i] === kCollision, part = isCollision ? 1 : 0.5;
        g.fillStyle = isCollision ? '#c14d00' : '#5b6875';
        g.globalAlpha = run.events.count > 400 ? 0.35 : 0.9;
        g.fillRect(x(run.events.time[i]) - 0.5, top + (1 - part) * size, 1, part * size);
      }
    });
    g.globalAlpha = 1;
    for (const [at, color] of [[this.player.about.stopped, '#8a5a00'], [this.player.about.difference, '#a82c00']]) {
      if (!at || at.time < from || at.time > until) continue;
      g.fillStyle = color;
      g.beginPath();
      g.moveTo(x(at.time), height);
      g.lineTo(x(at.time) - 5, 0);
      g.lineTo(x(at.time) + 5, 0);
      g.fill();
    }
  }
}
