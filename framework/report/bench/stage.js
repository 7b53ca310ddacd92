// What the bench draws: boxes and balls above a floor, in perspective on a canvas, and what a hand does there.
const middleOfView = [0, 0, 0.35];

Object.assign(Bench.prototype, {
  // Columns of the camera: right, up, and towards the eye; and the eye.
  eyes() {
    const { turn: a, rise: b, far } = this.camera;
    const back = [Math.cos(b) * Math.cos(a), Math.cos(b) * Math.sin(a), Math.sin(b)], right = [-Math.sin(a), Math.cos(a), 0];
    return { back, right, up: cross(back, right), eye: add(middleOfView, times(far, back)) };
  },
  sized() {
    const { canvas } = this, ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
    return { width, height, ratio, focal: Math.min(1.6 * height, 1.15 * width) };
  },
  project(view, size, p) {
    const d = sub(p, view.eye), depth = -dot(d, view.back), k = size.focal / Math.max(0.05, depth);
    return [size.width / 2 + k * dot(d, view.right), size.height / 2 - k * dot(d, view.up), depth];
  },
  // As far away as all that is drawn needs, within a limit: a wrong law may throw a body out of the world.
  fit() {
    const near = 1.9, farthest = 5, seen = 0.5;   // m; seen: beside the middle of the view, from nearby
    let most = 0;
    const hold = p => { const off = Math.max(Math.abs(p[2] - middleOfView[2]), Math.hypot(p[0], p[1]) / 1.3); if (Number.isFinite(off)) most = Math.max(most, off); };
    for (const { frames } of this.results)
      for (const { poses, lines } of frames) {
        for (let k = 0; k < poses.length; k += 7) hold(poses.slice(k, k + 3));
        for (const { kind, from, to } of lines) if (kind !== 'force') { hold(from); hold(to); }
      }
    this.camera.far = Math.min(farthest, Math.max(near, near * most / seen));
  },
  pose(result, body, frame) {
    const at = Math.min(Math.max(0, Math.round(frame)), result.frames.length - 1), p = result.frames[at].poses.slice(7 * body, 7 * body + 7);
    return { x: p.slice(0, 3), q: p.slice(3), shape: result.bodies[body].shape };
  },

  draw() {
    if (!this.canvas || this.results.length === 0) return;
    const size = this.sized(), view = this.eyes(), g = this.canvas.getContext('2d'), style = getComputedStyle(this.root);
    const colour = name => style.getPropertyValue(name).trim();
    g.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    g.fillStyle = colour('--wash');
    g.fillRect(0, 0, size.width, size.height);
    this.floor(g, view, size, colour('--line'));
    const [own, right] = this.results;
    if (own.frames.length > 0) this.drawRun(g, view, size, own, { edge: colour('--ink'), face: colour('--link'), dash: [] });
    if (right && right.frames.length > 0) this.drawRun(g, view, size, right, { edge: colour('--good'), face: '', dash: [6, 4] });
    if (this.hand) this.arrow(g, this.hand.from, this.hand.to, colour('--bad'));
    this.scrub.value = Math.round(this.t);
    const any = own.frames.length > 0 ? own : right;
    const now = any && any.frames.length > 0 ? any.frames[Math.min(Math.round(this.t), any.frames.length - 1)].t : 0;
    this.clock.textContent = `t = ${now.toFixed(2)} s`;
    this.scrub.setAttribute('aria-valuetext', this.clock.textContent);
  },
  floor(g, view, size, colour) {
    g.strokeStyle = colour;
    g.lineWidth = 1;
    g.setLineDash([]);
    for (let i = -4; i <= 4; ++i)
      for (const [a, b] of [[[i * 0.25, -1, 0], [i * 0.25, 1, 0]], [[-1, i * 0.25, 0], [1, i * 0.25, 0]]]) this.line(g, [this.project(view, size, a), this.project(view, size, b)]);
  },
  line(g, points) {
    g.beginPath();
    points.forEach(([x, y], i) => i === 0 ? g.moveTo(x, y) : g.lineTo(x, y));
    g.stroke();
  },
  drawRun(g, view, size, result, { edge, face, dash }) {
    g.strokeStyle = edge;
    g.lineWidth = 1.5;
    g.setLineDash(dash);
    const bodies = result.bodies.map((_, i) => this.pose(result, i, this.t)).filter(b => b.x.every(Number.isFinite));
    bodies.sort((a, b) => this.project(view, size, b.x)[2] - this.project(view, size, a.x)[2]);
    for (const body of bodies) {
      if (body.shape.kind === 'ball') {
        const [x, y, depth] = this.project(view, size, body.x);
        g.beginPath();
        g.arc(x, y, size.focal * body.shape.radius / Math.max(0.05, depth), 0, 2 * Math.PI);
        this.fill(g, face, 0.45);
        g.stroke();
      } else {
        this.drawBox(g, view, size, body, face);
      }
    }
    g.setLineDash([]);
    for (const line of result.frames[Math.min(Math.max(0, Math.round(this.t)), result.frames.length - 1)].lines) this.drawLine(g, view, size, line, edge);
  },
  // Of the bodies' colour, over them: none is thick enough to hide behind one. A force has a head where it acts.
  drawLine(g, view, size, { kind, from, to }, colour) {
    if (![...from, ...to].every(Number.isFinite) || norm(sub(to, from)) < 1e-6) return;
    const [a, b] = [from, to].map(p => this.project(view, size, p));
    if (kind === 'force') return this.arrow(g, b, a, colour);
    g.lineWidth = kind === 'rod' ? 3 : 1.5;
    const along = [b[0] - a[0], b[1] - a[1]], length = Math.hypot(...along), turns = kind === 'spring' && length > 1 ? 12 : 0;
    const aside = [-along[1] / length, along[0] / length].map(n => n * 0.02 * size.focal / Math.max(0.05, (a[2] + b[2]) / 2));
    const points = [a];
    for (let i = 0; i < turns; ++i) points.push([0, 1].map(n => a[n] + along[n] * (0.1 + 0.8 * (i + 0.5) / turns) + (i % 2 === 0 ? 1 : -1) * aside[n]));
    this.line(g, [...points, b]);
  },
  // The faces that look at the eye; lighter from above.
  drawBox(g, view, size, body, face) {
    const p = corners(body), faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    for (const corner of faces) {
      const [a, b, c] = corner.map(i => p[i]), middle = times(0.25, corner.map(i => p[i]).reduce(add)), across = cross(sub(b, a), sub(c, a));
      const out = dot(across, sub(middle, body.x)) < 0 ? times(-1, across) : across;
      if (dot(out, sub(view.eye, middle)) <= 0) continue;
      g.beginPath();
      corner.forEach((i, k) => { const [x, y] = this.project(view, size, p[i]); if (k === 0) g.moveTo(x, y); else g.lineTo(x, y); });
      g.closePath();
      this.fill(g, face, 0.35 + 0.3 * out[2] / norm(out));
      g.stroke();
    }
  },
  fill(g, face, weight) {
    if (face === '') return;
    g.save();
    g.globalAlpha = Math.max(0.15, weight);
    g.fillStyle = face;
    g.fill();
    g.restore();
  },
  arrow(g, from, to, colour) {
    g.strokeStyle = colour;
    g.lineWidth = 3;
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
    this.line(g, [from, to]);
    for (const side of [-0.4, 0.4]) this.line(g, [to, [to[0] - 12 * Math.cos(angle + side), to[1] - 12 * Math.sin(angle + side)]]);
  },

  // A drag from a body pushes it; from elsewhere it turns the view.
  listen() {
    const at = event => { const r = this.canvas.getBoundingClientRect(); return [event.clientX - r.left, event.clientY - r.top]; };
    this.canvas.onpointerdown = event => {
      event.preventDefault();
      this.canvas.focus();
      this.canvas.setPointerCapture(event.pointerId);
      const from = at(event);
      if (this.isOnBrick(from)) { this.setPlaying(false); this.hand = { from, to: from }; } else this.turning = from;
    };
    this.canvas.onpointermove = event => {
      const to = at(event);
      if (this.hand) this.hand.to = to;
      else if (this.turning) { this.turn((to[0] - this.turning[0]) / 150, (to[1] - this.turning[1]) / 150); this.turning = to; } else return;
      this.draw();
    };
    this.canvas.onpointerup = () => {
      const { hand } = this;
      this.hand = this.turning = null;
      if (hand) this.pushBy(hand);
    };
    this.canvas.onpointercancel = () => { this.hand = this.turning = null; this.draw(); };
    this.canvas.onkeydown = event => {
      const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
      if (event.key === ' ') this.setPlaying(!this.isPlaying);
      else if (turns[event.key]) this.turn(...turns[event.key]);
      else return;
      event.preventDefault();
      this.draw();
    };
  },
  turn(aside, up) {
    this.camera.turn -= aside;
    this.camera.rise = Math.min(1.4, Math.max(0.03, this.camera.rise + up));
  },
  // Near the brick of this file's run, on the screen; where a ray really hits is asked of the law.
  isOnBrick([x, y]) {
    const [own] = this.results;
    if (!this.one.takesPushes || !own || own.frames.length === 0) return false;
    const size = this.sized(), view = this.eyes(), points = corners(this.pose(own, 0, this.t)).map(p => this.project(view, size, p));
    const [xs, ys] = [points.map(p => p[0]), points.map(p => p[1])];
    return x >= Math.min(...xs) && x <= Math.max(...xs) && y >= Math.min(...ys) && y <= Math.max(...ys);
  },
  pushBy({ from, to }) {
    const size = this.sized(), view = this.eyes(), [own] = this.results;
    const aside = to[0] - from[0], above = from[1] - to[1];
    if (Math.hypot(aside, above) < 5) return this.draw();
    const d = add(add(times((from[0] - size.width / 2) / size.focal, view.right), times((size.height / 2 - from[1]) / size.focal, view.up)), times(-1, view.back));
    const newtons = 0.5;   // for each pixel of the drag
    const F = add(times(newtons * aside, view.right), times(newtons * above, view.up));
    this.pushes.push({ t: own.frames[Math.min(Math.round(this.t), own.frames.length - 1)].t, ray: { o: view.eye, d }, F });
    this.ask().then(() => this.setPlaying(true));
  },
});

async function openBench(root) {
  const say = words => { root.textContent = words; };
  say('The code is being started ...');   // instead of what a browser without scripts shows
  try {
    const worker = URL.createObjectURL(new Blob([await opened('bench-worker').then(bytes => new TextDecoder().decode(bytes))], { type: 'text/javascript' }));
    const [own, right] = await Promise.all([opened('bench-own'), opened('bench-right')]);
    const bench = new Bench(root, new Runner(own, worker), right === null ? null : new Runner(right, worker));
    root.bench = bench;   // for the browser's console
    const first = await bench.own.experiments();
    if (bench.right) await bench.right.experiments();
    if (!first.list) return say(`The code does not start in this page. ${stoppedWords(first.stopped)}.`);
    bench.build(first.list);
  } catch (error) {
    say(`This browser does not run the code in this page (${error.message}). The pictures and numbers of the page need none of it.`);
  }
}

openBench(document.getElementById('bench'));
