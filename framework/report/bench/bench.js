// The part of a page in which a submission's own code answers: controls, a stage, numbers.
// The module runs in a worker and is ended where it does not answer; this script never touches it.

const $ = (tag, words = '', attributes = {}) => {
  const node = document.createElement(tag);
  node.textContent = words;
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
};
const longestCall = 2000;   // ms without a word of the worker
const isDifferent = (a, b) => Math.abs(a - b) > 1e-12 * Math.max(1, Math.abs(a), Math.abs(b)) || Number.isNaN(a) !== Number.isNaN(b);
const shown = x => typeof x !== 'number' ? String(x) : Number.isNaN(x) ? 'none' : x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5) ? x.toExponential(2) : String(+x.toPrecision(5));

async function opened(id) {
  const element = document.getElementById(id);
  if (element === null) return null;
  const packed = Uint8Array.from(atob(element.textContent), c => c.charCodeAt(0));
  return new Uint8Array(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
}

// One module in its worker: `run` answers with a result, or with why there is none.
class Runner {
  constructor(wasm, script) { this.wasm = wasm; this.address = script; this.worker = null; this.pending = null; this.count = 0; }

  start() {
    this.worker = new Worker(this.address);
    this.calling = '';
    this.worker.onmessage = ({ data }) => this.hear(data);
    this.worker.onerror = event => { event.preventDefault(); this.hear({ trouble: event.message || 'the worker failed' }); };
    this.worker.postMessage({ wasm: this.wasm });
  }
  hear(data) {
    if (this.pending === null) return;
    this.watch();
    if (data.calling !== undefined) this.calling = data.calling;
    else if (data.ready) this.pending.ready?.(data.ready);
    else if (data.trouble) this.end({ stopped: { t: 0, kind: 'crashed', name: '', words: data.trouble } });
    else if (data.run === this.count) this.end(data.result);
  }
  watch() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.worker.terminate();
      this.worker = null;
      this.end({ stopped: { t: null, kind: 'out of time', name: this.calling, words: this.calling === '' ? 'the module did not start' : `it was called and gave no answer within ${longestCall / 1000} s` } });
    }, longestCall);
  }
  end(result) {
    clearTimeout(this.timer);
    const { done } = this.pending;
    this.pending = null;
    done({ bodies: [], frames: [], calls: [], facts: [], ...result });
  }
  // The experiments that there are; nothing where the module does not start.
  experiments() {
    return new Promise(resolve => {
      this.pending = { ready: list => { clearTimeout(this.timer); this.pending = null; resolve({ list }); }, done: resolve };
      this.start();
      this.watch();
    });
  }
  run(request) {
    return new Promise(done => {
      this.pending = { done };
      if (this.worker === null) this.start();
      this.watch();
      this.worker.postMessage({ run: ++this.count, ...request });
    });
  }
}

// Two runs of the same calls: the first that answers otherwise had the same arguments.
function firstDifference(own, right) {
  const n = Math.min(own.calls.length, right.calls.length);
  for (let i = 0; i < n; ++i) {
    const a = own.calls[i], b = right.calls[i];
    if (a.name !== b.name || a.answer.length !== b.answer.length || a.answer.some((x, k) => isDifferent(x, b.answer[k]))) return { number: i + 1, name: a.name, t: a.t, own: a.answer, right: b.answer };
  }
  return null;
}

function stoppedWords({ t, kind, name, words }) {
  const when = t === null || t === undefined ? '' : ` at t = ${shown(t)} s`;
  return { 'not attempted': `Not attempted${when}: ${name}: ${words}`, 'threw': `Threw${when}: ${name}: ${words}`, 'crashed': `Crashed${when}: ${name === '' ? '' : `${name}: `}${words}`,
    'out of time': `Out of time: ${name === '' ? '' : `${name}: `}${words}. The page has ended it and goes on` }[kind] || `Wrong${when}: ${name}: ${words}`;
}

class Bench {
  constructor(root, own, right) {
    Object.assign(this, { root, own, right, pushes: [], t: 0, isPlaying: false, results: [] });
    this.camera = { turn: -1.2, rise: 0.25, far: 1.9 };
  }

  build(list) {
    this.list = list;
    this.root.textContent = '';
    const choose = $('select', '', { id: 'bench-choose' });
    list.forEach((one, i) => choose.append($('option', one.title, { value: i })));
    choose.onchange = () => this.take(+choose.value);
    const label = $('label', 'Try: ', { class: 'bench-choose' });
    label.append(choose);
    this.about = $('p', '', { class: 'muted' });
    this.controls = $('div', '', { class: 'bench-controls' });
    this.canvas = $('canvas', '', { tabindex: 0, role: 'img', 'aria-describedby': 'bench-state', 'aria-label': 'The motion. Drag to turn the view, or from a brick to push it where the text says so; arrow keys turn it, too.' });
    this.scrub = $('input', '', { type: 'range', min: 0, max: 0, step: 1, value: 0, 'aria-label': 'Time' });
    this.clock = $('output', '', { class: 'bench-clock' });
    this.play = $('button', 'Play', { type: 'button' });
    const again = $('button', 'Reset controls', { type: 'button' });
    this.clear = $('button', 'Undo pushes', { type: 'button' });
    this.state = $('p', '', { id: 'bench-state', role: 'status', 'aria-live': 'polite' });
    this.difference = $('p');
    this.numbers = $('div', '', { class: 'wide', tabindex: 0 });
    const bar = $('div', '', { class: 'bench-bar' });
    bar.append(this.play, this.scrub, this.clock, this.clear, again);
    const legend = $('p', this.right ? 'Solid: this file. Dashed: the right law.' : 'Drawn by the laws of this file alone.', { class: 'muted' });
    this.root.append(label, this.about, this.controls, this.canvas, bar, legend, this.state, this.difference, this.numbers);
    this.play.onclick = () => this.setPlaying(!this.isPlaying);
    this.clear.onclick = () => { this.pushes = []; this.ask(); };
    again.onclick = () => this.take(+choose.value);
    this.scrub.oninput = () => { this.setPlaying(false); this.t = +this.scrub.value; this.draw(); };
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
    this.take(0);
  }

  take(i) {
    this.one = this.list[i];
    this.pushes = [];
    this.values = {};
    this.about.textContent = this.one.about;
    this.controls.textContent = '';
    for (const control of this.one.controls) {
      this.values[control.id] = control.value;
      const out = $('output'), row = $('label'), input = $('input', '', { type: 'range', id: `bench-${control.id}`, min: control.min, max: control.max, step: control.step, value: control.value });
      const say = () => { out.textContent = `${shown(this.values[control.id])} ${control.unit}`; input.setAttribute('aria-valuetext', out.textContent); };
      input.oninput = () => { this.values[control.id] = +input.value; say(); this.ask(); };
      row.append($('span', control.label), input, out);
      this.controls.append(row);
      say();
    }
    this.t = 0;
    this.ask();
  }

  // One run of both laws; what changes meanwhile is run next.
  async ask() {
    this.isStale = true;
    if (this.isAsking) return;
    this.isAsking = true;
    while (this.isStale) {
      this.isStale = false;
      const request = { id: this.one.id, values: { ...this.values }, pushes: this.pushes };
      this.state.className = 'muted';
      this.state.textContent = 'Running ...';
      this.results = await Promise.all([this.own, this.right].filter(Boolean).map(runner => runner.run(request)));
    }
    this.isAsking = false;
    this.show();
  }

  show() {
    const [own, right] = this.results;
    this.fit();
    this.scrub.max = Math.max(0, ...this.results.map(r => r.frames.length - 1));
    this.t = Math.min(this.t, +this.scrub.max);
    this.clear.disabled = this.pushes.length === 0;
    if (own.stopped) this.say('bad', `${stoppedWords(own.stopped)}.`);
    else this.say('muted', `Ran to the end: ${own.calls.length} calls of this file.`);
    this.difference.textContent = '';
    const wrong = own.facts.filter(fact => this.verdict(fact) === 'wrong').length;
    if (right) {
      const first = firstDifference(own, right);
      this.difference.className = first ? 'bad' : 'good';
      if (first) this.difference.textContent = `The first call that differs is number ${first.number}: ${first.name} at t = ${shown(first.t)} s, with the same arguments for both laws. This file answers ${first.own.map(shown).join(', ') || 'nothing'}; the right law ${first.right.map(shown).join(', ') || 'nothing'}.`;
      else if (!own.stopped) this.difference.textContent = 'Every call of this file answers as the right law does, to 1e-12.';
    } else if (own.facts.length > 0) {
      this.difference.className = wrong > 0 ? 'bad' : 'good';
      this.difference.textContent = wrong === 1 ? 'One of the numbers below is not as it has to be.' : wrong > 0 ? `${wrong} of the numbers below are not as they have to be.` : 'The numbers below are as they have to be.';
    }
    this.root.dataset.shown = String(this.shownRuns = (this.shownRuns || 0) + 1);
    this.table(own, right);
    this.draw();
    if (this.shownRuns === 1 && !matchMedia('(prefers-reduced-motion: reduce)').matches) this.setPlaying(true);
  }
  say(look, words) { this.state.className = look; this.state.textContent = words; }

  verdict({ value, wanted, tolerance }) {
    if (wanted === null) return '';
    if (Number.isNaN(value)) return 'wrong';
    return (wanted === 'not above 0' ? value <= tolerance : Math.abs(value - wanted) <= tolerance) ? 'right' : 'wrong';
  }

  table(own, right) {
    this.numbers.textContent = '';
    if (own.facts.length === 0) return;
    const table = $('table', '', { class: 'blocks' }), head = $('tr'), body = $('tbody');
    for (const name of ['', 'What has to hold', 'has to be', 'this file', ...(right ? ['the right law'] : [])]) head.append($('th', name, { scope: 'col' }));
    own.facts.forEach((fact, i) => {
      const row = $('tr'), verdict = this.verdict(fact), other = right && right.facts[i];
      const number = (text, column) => $('td', text, { class: 'number', 'data-name': column });   // a narrow page has the names of columns in the cells
      row.append($('td', verdict, { class: { right: 'good', wrong: 'bad', '': 'muted' }[verdict] }), $('td', fact.unit === '' ? fact.name : `${fact.name} [${fact.unit}]`), number(fact.wanted === null ? '' : shown(fact.wanted), 'has to be'), number(shown(fact.value), 'this file'));
      if (right) row.append(number(other ? shown(other.value) : '', 'the right law'));
      body.append(row);
    });
    const top = $('thead');
    top.append(head);
    table.append(top, body);
    this.numbers.append(table);
  }

  setPlaying(is) {
    this.isPlaying = is;
    this.play.textContent = is ? 'Pause' : 'Play';
    if (!is) return;
    if (this.t >= +this.scrub.max) this.t = 0;
    let before = null;
    const timed = this.results.find(r => r.frames.length > 1), span = timed ? timed.frames[1].t - timed.frames[0].t : 1 / 60;
    const tick = now => {
      if (!this.isPlaying) return;
      const seconds = before === null ? 0 : Math.min(0.1, (now - before) / 1000);
      before = now;
      this.t = Math.min(+this.scrub.max, this.t + seconds / span);
      this.draw();
      if (this.t >= +this.scrub.max) this.setPlaying(false);
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
