// Curves that grow with the run: colour and dashes say which one; those of the run before are thin and pale.

const kCurvePlots = [
  { title: 'Energy', unit: 'J', curves: [['kinetic', 'kinetic', 0], ['potential', 'potential', 1]] },
  { title: 'Change of the total energy', unit: 'J', curves: [['drift', 'E − E(0)', 2]] },
  { title: 'Momentum of all movable bodies', unit: 'kg m/s', curves: [['px', 'x', 0], ['py', 'y', 1], ['pz', 'z', 2]] },
  { title: 'Angular momentum about the origin', unit: 'kg m²/s', curves: [['lx', 'x', 0], ['ly', 'y', 1], ['lz', 'z', 2]] },
  { title: 'Smallest gap between two bodies', unit: 'm', curves: [['gap', 'gap', 3]] },
];
const kCurveColors = { light: ['#00446b', '#c14d00', '#007a57', '#9a4f86'], dark: ['#7cc0f4', '#ff9a5c', '#5fcfa8', '#e0a0d0'] };

class GrowingPlot {
  constructor(about) {
    this.about = about;
    this.canvas = html('canvas', { role: 'img' });
    this.canvas.setAttribute('aria-label', about.title);
    this.values = about.curves.map(() => html('b'));
    this.keys = about.curves.map((_, i) => element('line', { x1: 0, x2: 28, y1: 4, y2: 4, 'stroke-width': 2.4, 'stroke-dasharray': kStyles[i][1] }));
    const keyOf = i => { const key = element('svg', { viewBox: '0 0 28 8', class: 'key', 'aria-hidden': 'true' }); key.append(this.keys[i]); return key; };
    this.box = html('figure', { className: 'plot' }, html('h2', { className: 'minor' }, `${about.title} [${about.unit}]`), this.canvas,
      html('figcaption', {}, ...about.curves.map(([, name], i) => html('span', {}, keyOf(i), `${name} `, this.values[i]))));
  }

  range(runs, names) {
    let low = Infinity, high = -Infinity;
    for (const run of runs)
      for (const name of names)
        for (const v of run.curves[name]) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
    if (!(low <= high)) return [0, 1];
    const least = 1e-4 * Math.max(Math.abs(low), Math.abs(high)), room = Math.max(0.07 * (high - low), 0.5 * (least - (high - low)), low === high && low === 0 ? 1 : 0);
    return [low - room, high + room];
  }

  draw(run, former, t) {
    const canvas = this.canvas, ratio = Math.min(2, window.devicePixelRatio || 1), width = canvas.clientWidth, height = canvas.clientHeight;
    if (width === 0) return;
    if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
    const g = canvas.getContext('2d'), style = getComputedStyle(document.body), ink = style.getPropertyValue('--soft'), line = style.getPropertyValue('--line');
    const colors = kCurveColors[window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light'];
    const names = this.about.curves.map(curve => curve[0]), runs = former ? [run, former] : [run], left = 58, right = width - 6, top = 4, bottom = height - 18;
    const end = Math.max(run.end || 0, former ? Math.min(former.end || 0, 1.5 * (run.end || 0)) : 0, 0.5), [low, high] = this.range(runs, names);
    const x = s => left + s / end * (right - left), y = v => bottom - (v - low) / (high - low) * (bottom - top);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    g.font = '11px "DejaVu Sans", Arial, sans-serif';
    g.lineWidth = 1;
    g.textAlign = 'right';
    const ups = ticksOf(low, high, 4), upWords = tickWords(ups, false);
    ups.forEach((v, i) => {
      g.fillStyle = line;
      g.fillRect(left, y(v), right - left, 1);
      g.fillStyle = ink;
      g.fillText(upWords[i], left - 5, y(v) + 4);
    });
    g.textAlign = 'center';
    const across = ticksOf(0, end, 6), acrossWords = tickWords(across, false);
    across.forEach((s, i) => {
      g.fillStyle = line;
      g.fillRect(x(s), top, 1, bottom - top);
      g.fillStyle = ink;
      g.fillText(acrossWords[i], x(s), bottom + 13);
    });
    runs.slice().reverse().forEach(one => {
      g.globalAlpha = one === former ? 0.5 : 1;
      g.lineWidth = one === former ? 1 : 1.7;
      this.about.curves.forEach(([name, , color], i) => {
        g.setLineDash(kStyles[i][1].split(' ').filter(Boolean).map(Number));
        this.trace(g, one, one.curves[name], x, y, colors[color], end);
      });
    });
    g.globalAlpha = 1;
    g.setLineDash([]);
    g.fillStyle = style.getPropertyValue('--bad');
    g.fillRect(x(t), top, 1.2, bottom - top);
    const k = run.frameAt(t).k;
    this.about.curves.forEach(([name, , color], i) => { this.values[i].textContent = short(run.curves[name][k]); this.keys[i].setAttribute('stroke', colors[color]); });
  }

  // Of many points the least and the largest in each column.
  trace(g, run, values, x, y, color, end) {
    const n = values.length, parts = Math.min(n, 400);
    g.strokeStyle = color;
    g.beginPath();
    let down = false;
    const to = i => {
      if (!Number.isFinite(values[i]) || run.times[i] > end) { down = false; return; }
      if (down) g.lineTo(x(run.times[i]), y(values[i])); else g.moveTo(x(run.times[i]), y(values[i]));
      down = true;
    };
    for (let part = 0; part < parts; ++part) {
      const from = Math.floor(part * n / parts), until = Math.floor((part + 1) * n / parts);
      let least = from;
      while (least + 1 < until && !Number.isFinite(values[least])) ++least;   // with which nothing compares
      let most = least;
      for (let i = least; i < until; ++i) {
        if (!Number.isFinite(values[i])) continue;
        if (values[i] < values[least]) least = i;
        if (values[i] > values[most]) most = i;
      }
      to(Math.min(least, most));
      if (least !== most) to(Math.max(least, most));
    }
    g.stroke();
  }
}

// Local virtual times while they run: a bar a process, dark up to global virtual time.
class TimesChart {
  constructor() {
    this.canvas = html('canvas', { className: 'times', role: 'img' });
    this.canvas.setAttribute('aria-label', 'Local virtual times as bars');
    this.words = html('p', { className: 'soft' });
    this.box = html('div', {}, html('p', {}, 'Each body a logical process: bright as far as it has gone ahead, dark as far as global virtual time has committed it, hatched what a rollback has undone.'), this.words, this.canvas);
    this.clear();
  }

  clear() { this.names = []; this.times = []; this.undone = []; this.moves = 0; this.rollbacks = 0; this.gvt = 0; this.history = []; this.isCut = false; }

  add(message) {
    if (message.from < this.moves) this.clear();
    this.names = message.processes;
    this.isCut = this.isCut || Boolean(message.is_cut);
    while (this.times.length < this.names.length) this.times.push(0);
    for (const [process, from, to, gvt] of message.moves) {
      this.times[process] = to;
      this.gvt = gvt;
      ++this.moves;
      if (to <= from) { ++this.rollbacks; this.undone.push({ process, from, to, move: this.moves }); if (this.undone.length > 40) this.undone.shift(); }
    }
  }

  told() {
    const rollbacks = `${this.rollbacks} rollback${this.rollbacks === 1 ? '' : 's'}`, until = `global virtual time ${short(this.gvt)} s`;
    if (!this.isCut) return `${this.moves} moves of the scheduler, ${rollbacks}; ${until}`;
    return `The first ${this.moves} moves of the scheduler, ${rollbacks}; ${until}. Later moves are not recorded, because there are more than are kept: the run goes on, and the bars stay.`;
  }

  draw(end) {
    const kRow = 17, left = 96, top = 22, ratio = Math.min(2, window.devicePixelRatio || 1), width = this.canvas.clientWidth, rows = Math.min(this.names.length, 120), height = top + rows * kRow + 20;
    if (width === 0) return;
    this.canvas.style.height = `${height}px`;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const g = this.canvas.getContext('2d'), style = getComputedStyle(document.body), ink = style.getPropertyValue('--ink'), far = Math.max(end, ...this.times, 0.1), x = t => left + t / far * (width - left - 10), bottom = top + rows * kRow;
    g.scale(ratio, ratio);
    g.font = '11px "DejaVu Sans", Arial, sans-serif';
    g.textAlign = 'center';
    for (const t of ticksOf(0, far, 6)) {
      g.fillStyle = style.getPropertyValue('--line');
      g.fillRect(x(t), top, 1, bottom - top);
      g.fillStyle = ink;
      g.fillText(short(t, 5), x(t), bottom + 13);
    }
    for (let i = 0; i < rows; ++i) {
      const y = top + i * kRow + 3, tall = kRow - 6;
      g.textAlign = 'right';
      g.fillStyle = ink;
      g.fillText(this.names[i].length > 14 ? `${this.names[i].slice(0, 13)}…` : this.names[i], left - 6, y + 9);
      g.fillStyle = '#3d8fc4';
      g.fillRect(x(0), y, x(this.times[i]) - x(0), tall);
      g.fillStyle = '#00446b';
      g.fillRect(x(0), y, x(Math.min(this.times[i], this.gvt)) - x(0), tall);
    }
    for (const cut of this.undone) {
      if (cut.process >= rows) continue;
      const y = top + cut.process * kRow + 1, tall = kRow - 2;
      g.fillStyle = '#c14d00';
      g.globalAlpha = Math.max(0.2, 1 - (this.moves - cut.move) / 60);
      g.fillRect(x(cut.to) - 1, y, 2, tall);
      for (let at = x(cut.to); at < x(cut.from); at += 4) g.fillRect(at, y + 2, 1.5, tall - 4);
      g.globalAlpha = 1;
    }
    g.fillStyle = ink;
    g.fillRect(x(this.gvt) - 1, top - 4, 2, bottom - top + 4);
    g.textAlign = 'left';
    g.fillText('GVT', Math.min(x(this.gvt) + 4, width - 30), top - 6);
    this.words.textContent = this.told();
  }
}
