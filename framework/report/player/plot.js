// Functions that draw engines' own charts, by kind: (element, data, player) => ({ at(time_s) {} }).
// panel_*.js register here.
const panelKinds = {};

// Plots over time, in the style of framework/report/plot.h: a frame, round ticks, units on both axes, curves that differ in lightness and dashes.

const kStyles = [['#00446b', ''], ['#c14d00', '7 3'], ['#007a57', '2 2.5'], ['#9a4f86', '9 3 2 3'], ['#3d8fc4', '4 2'], ['#8a6d00', '1.5 4']];
const kRunDashes = ['', '6 4'];
const kFrame = { width: 480, height: 190, left: 66, margin: 14, top: 10, bottom: 152 };   // of a pane at least as wide; in a narrower one letters keep their size and the frame is narrower

function element(name, attributes = {}, text) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function html(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) key in made && key !== 'list' ? made[key] = value : made.setAttribute(key, value);
  made.append(...children);
  return made;
}

// Of tabs, or of buttons of which one holds, one is a stop of the keyboard; arrows go to the others.
// @param word  the attribute that says which one holds: aria-selected, aria-checked
function oneStop(list, word) {
  const all = () => [...list.children].filter(one => !one.hidden), mark = () => { for (const one of list.children) one.tabIndex = one.getAttribute(word) === 'true' ? 0 : -1; };
  list.addEventListener('keydown', event => {
    const way = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key], at = all().indexOf(document.activeElement);
    if (!way || at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const next = all()[(at + way + all().length) % all().length];
    next.click();
    next.focus();
    event.preventDefault();
    event.stopPropagation();
  });
  new MutationObserver(mark).observe(list, { subtree: true, childList: true, attributes: true, attributeFilter: [word] });
  mark();
}

// What is built anew below an element keeps the keyboard where it was: at the control of the same name.
function keepFocus(box, build) {
  const at = document.activeElement, kControls = 'button, input, select, summary, a, pre';
  const nameOf = e => [e.tagName, e.closest('[data-test]')?.dataset.test, e.ariaLabel || (e.tagName === 'SUMMARY' ? '' : e.textContent)].join();
  const isInside = Boolean(at && at !== box && box.contains(at)), name = isInside ? nameOf(at) : '';
  build();
  if (!isInside || document.activeElement === at) return;
  const same = at.isConnected ? at : [...box.querySelectorAll(kControls)].find(e => nameOf(e) === name);
  if (same) same.focus({ preventScroll: true });
}

function ticksOf(low, high, most = 6) {
  const rough = (high - low) / most, power = Math.pow(10, Math.floor(Math.log10(rough))), part = rough / power;
  const spacing = (part > 5 ? 10 : part > 2 ? 5 : part > 1 ? 2 : 1) * power, ticks = [];
  for (let i = Math.ceil(low / spacing - 1e-9); i * spacing <= high + 1e-9 * spacing; ++i) ticks.push(i * spacing);
  return ticks;
}

// The numbers of an axis, all in one style: plain, or, where one would be long, with powers of ten; of a linear axis all with the power of the largest.
function tickWords(ticks, isLog) {
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : 0, sizes = ticks.map(v => Math.abs(v)), largest = Math.max(...sizes), least = Math.min(...sizes);
  const needsPowers = largest > 0 && (largest >= (isLog ? 1e4 : 1e6) * (1 - 1e-9) || (isLog ? least : largest) < 1e-3 * (1 - 1e-9)), exponentOf = v => Math.floor(Math.log10(v) + 1e-9);
  return ticks.map((v, i) => {
    if (v === 0 || (!isLog && sizes[i] < 1e-9 * step)) return '0';
    if (!needsPowers) return String(Number(v.toPrecision(7)));
    const exponent = exponentOf(isLog ? sizes[i] : largest);
    return `${Number((v / Math.pow(10, exponent)).toPrecision(7))}e${exponent}`;
  });
}

function decadesOf(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9), stride = Math.max(1, Math.floor((last - first + 5) / 5)), ticks = [];
  for (let power = first; power <= last; power += stride) ticks.push(Math.pow(10, power));
  if (ticks.length >= 3) return ticks;
  // at least three numbers: between powers of ten, or of equal distance
  const between = [];
  for (let power = first - 1; power <= last; ++power)
    for (const part of [1, 2, 5]) if (part * Math.pow(10, power) >= low && part * Math.pow(10, power) <= high) between.push(part * Math.pow(10, power));
  return between.length >= 3 ? between : ticksOf(low, high, 4);
}

// A few digits: 0.0123, 12.3, 1.2e-9.
function short(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return Number(value.toPrecision(Math.max(2, digits - 1))).toExponential().replace('e+', 'e');
  return String(Number(value.toPrecision(digits)));
}

// With the digits that double precision and the page's rounding leave: 1000000.25.
function allDigits(value) { return Number.isFinite(value) ? String(Number(value.toPrecision(11))) : '–'; }

// A value of a curve; of one that is drawn from an offset the true value.
function valueInWords(curve, k, digits) { return curve.offset === undefined ? short(curve.values[k], digits) : allDigits(curve.values[k] + curve.offset); }

// Of two runs the colour says the quantity and the dashes the run; of one run both say the quantity.
function stylesOf(curves) {
  const quantities = [...new Set(curves.map(curve => curve.link))], isOfTwo = curves.some(curve => curve.run > 0);
  return curves.map((curve, i) => (isOfTwo ? [kStyles[quantities.indexOf(curve.link) % kStyles.length][0], kRunDashes[curve.run]] : kStyles[i % kStyles.length]));
}

// How much more time is shown after a turn of the wheel.
function zoomOf(event) { return Math.exp(Math.max(-0.5, Math.min(0.5, 0.004 * event.deltaY))); }

class TimePlot {
  // @param plot {title, heading (where it says more than the title), axis, unit, isLog, curves: [{name, times, values, offset (of the true value), frameAt}]}; seek(t) is called on a click or
  //   drag, zoom(factor, t) on the wheel with the control key (and by two fingers on a touch pad), zoom(Infinity) on a double click
  constructor(plot, end, seek, zoom = () => {}) {
    this.plot = plot;
    this.end = end > 0 ? end : 1;
    this.from = 0;
    this.until = this.end;
    this.hidden = new Set();   // places in plot.curves
    this.box = html('figure', { className: 'curve' });
    this.readouts = [];
    this.styles = stylesOf(plot.curves);
    this.width = kFrame.width;
    this.svg = element('svg', { class: 'plot', role: 'img', 'aria-label': plot.title });
    // The cursors are elements above the drawing: moving them repaints nothing.
    this.cursor = html('div', { className: 'cursor' });
    this.hover = html('div', { className: 'cursor hover', hidden: true });
    this.tip = html('div', { className: 'tip', hidden: true });
    const holder = html('div', { className: 'holder' }, this.svg, this.cursor, this.hover, this.tip);
    const legend = html('figcaption', { className: 'legend' });
    plot.curves.forEach((curve, i) => legend.append(this.legendEntry(curve, i)));
    this.box.append(html('h2', { className: 'minor' }, plot.heading || plot.title), holder, legend);
    this.draw();
    new ResizeObserver(() => this.fit()).observe(this.svg);
    this.svg.addEventListener('pointerdown', event => { this.svg.setPointerCapture(event.pointerId); seek(this.timeAt(event)); });
    this.svg.addEventListener('pointermove', event => { if (event.buttons) seek(this.timeAt(event)); this.tell(event); });
    for (const name of ['pointerleave', 'pointercancel']) this.svg.addEventListener(name, () => { this.hover.hidden = this.tip.hidden = true; });
    this.svg.addEventListener('wheel', event => { if (!event.ctrlKey) return; event.preventDefault(); zoom(zoomOf(event), this.timeAt(event)); }, { passive: false });
    this.svg.addEventListener('dblclick', () => zoom(Infinity));
  }

  get right() { return this.width - kFrame.margin; }

  // A narrow pane has a narrow drawing, not small letters.
  fit() {
    const wide = this.svg.clientWidth, width = wide > 0 ? Math.min(kFrame.width, wide) : kFrame.width;
    if (width === this.width) return;
    this.width = width;
    this.draw();
  }

  timeAt(event) {
    const box = this.svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width * this.width;
    return this.from + Math.min(1, Math.max(0, (x - kFrame.left) / (this.right - kFrame.left))) * (this.until - this.from);
  }

  // The part of time that is drawn.
  setWindow(from, until) {
    if (from === this.from && until === this.until) return;
    [this.from, this.until] = [from, until];
    this.draw();
  }

  draw() {
    this.svg.textContent = '';
    this.svg.setAttribute('viewBox', `0 0 ${this.width} ${kFrame.height}`);
    this.find();
    this.drawFrame();
    const { left, top, bottom } = kFrame, right = this.right, size = { x: left, y: top, width: right - left, height: bottom - top };
    this.curves = element('svg', { ...size, viewBox: `${left} ${top} ${size.width} ${size.height}` });   // cuts off what is outside
    this.plot.curves.forEach((curve, i) => { if (!this.hidden.has(i)) this.drawCurve(curve, this.styles[i]); });
    this.svg.append(this.curves);
  }

  // Of a curve the first and last place that the drawn part of time needs.
  placesOf(curve) {
    return this.from <= 0 && this.until >= this.end ? [0, curve.values.length - 1] : [curve.frameAt(this.from), Math.min(curve.values.length - 1, curve.frameAt(this.until) + 1)];
  }

  find() {
    let low = Infinity, high = -Infinity;
    this.plot.curves.forEach((curve, i) => {
      if (this.hidden.has(i)) return;
      const [first, last] = this.placesOf(curve);
      for (let k = first; k <= last; ++k) {
        const v = curve.values[k];
        if (Number.isFinite(v) && (!this.plot.isLog || v > 0)) { low = Math.min(low, v); high = Math.max(high, v); }
      }
    });
    this.isEmpty = !(low <= high);
    if (this.isEmpty) [low, high] = this.plot.isLog ? [0.1, 1] : [0, 1];
    if (this.plot.isLog) {
      const room = Math.pow(10, 0.06 * Math.max(0.5, Math.log10(high / low)));
      [this.low, this.high] = [low / room, high * room];
    } else {
      // A curve that is constant to six digits is drawn as a straight line, with ticks that differ.
      const least = 1e-4 * Math.max(Math.abs(low), Math.abs(high)), room = high > low || least > 0 ? Math.max(0.07 * (high - low), 0.5 * (least - (high - low))) : 1;
      [this.low, this.high] = [low - room, high + room];
    }
  }

  x(t) { return kFrame.left + (t - this.from) / (this.until - this.from) * (this.right - kFrame.left); }

  y(v) {
    const part = this.plot.isLog ? Math.log(Math.max(v, this.low) / this.low) / Math.log(this.high / this.low) : (v - this.low) / (this.high - this.low);
    return kFrame.bottom - part * (kFrame.bottom - kFrame.top);
  }

  drawFrame() {
    const { left, top, bottom } = kFrame, right = this.right, ups = this.plot.isLog ? decadesOf(this.low, this.high) : ticksOf(this.low, this.high, 5), words = tickWords(ups, this.plot.isLog);
    ups.forEach((v, i) => {
      const y = this.y(v);
      this.svg.append(element('line', { x1: left, x2: right, y1: y, y2: y, class: 'grid' }), element('text', { x: left - 6, y: y + 4, 'text-anchor': 'end' }, words[i]));
    });
    const across = ticksOf(this.from, this.until, this.width < 420 ? 4 : 6), times = tickWords(across, false);
    across.forEach((t, i) => {
      this.svg.append(element('line', { x1: this.x(t), x2: this.x(t), y1: top, y2: bottom, class: 'grid' }), element('text', { x: this.x(t), y: bottom + 15, 'text-anchor': 'middle' }, times[i]));
    });
    this.svg.append(element('rect', { x: left, y: top, width: right - left, height: bottom - top, fill: 'none', stroke: '#5b6875' }),
      element('text', { x: (left + right) / 2, y: bottom + 31, 'text-anchor': 'middle' }, 'time [s]'),
      element('text', { transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle' }, `${this.plot.axis} [${this.plot.unit}]`));
    if (this.isEmpty) this.svg.append(element('text', { x: (left + right) / 2, y: (top + bottom) / 2, 'text-anchor': 'middle' }, this.plot.isLog ? 'nowhere above 0' : 'nothing to draw'));
  }

  // Of many points only the minimum and maximum in each column of the screen.
  drawCurve(curve, [colour, dashes]) {
    const [first, last] = this.placesOf(curve), n = last - first + 1, parts = Math.min(n, 500);
    let path = '', down = false;
    const to = i => {
      const v = curve.values[i];
      if (!Number.isFinite(v) || (this.plot.isLog && !(v > 0))) { down = false; return; }
      path += `${down ? 'L' : 'M'}${this.x(curve.times[i]).toFixed(1)} ${this.y(v).toFixed(1)}`;
      down = true;
    };
    for (let part = 0; part < parts; ++part) {
      const from = first + Math.floor(part * n / parts), until = first + Math.floor((part + 1) * n / parts);
      let least = from;
      while (least + 1 < until && !Number.isFinite(curve.values[least])) ++least;   // with which nothing compares
      let largest = least;
      for (let i = least; i < until; ++i) {
        if (!Number.isFinite(curve.values[i])) continue;
        if (curve.values[i] < curve.values[least]) least = i;
        if (curve.values[i] > curve.values[largest]) largest = i;
      }
      to(Math.min(least, largest));
      if (least !== largest) to(Math.max(least, largest));
    }
    this.curves.append(element('path', { d: path, fill: 'none', stroke: colour, 'stroke-width': 1.7, 'stroke-linejoin': 'round', 'stroke-dasharray': dashes }));
  }

  // A button: a click hides the curve and shows it again.
  legendEntry(curve, i) {
    const [colour, dashes] = this.styles[i], key = element('svg', { viewBox: '0 0 28 8', class: 'key', 'aria-hidden': 'true' });
    key.append(element('line', { x1: 0, x2: 28, y1: 4, y2: 4, stroke: colour, 'stroke-width': 2.4, 'stroke-dasharray': dashes }));
    const value = html('b', {}, ''), entry = html('button', { className: 'entry', title: 'Hide or show this curve' }, key, ` ${curve.name} `, value);
    entry.setAttribute('role', 'checkbox');
    entry.setAttribute('aria-checked', 'true');
    entry.addEventListener('click', () => {
      this.hidden.has(i) ? this.hidden.delete(i) : this.hidden.add(i);
      entry.setAttribute('aria-checked', String(!this.hidden.has(i)));
      this.draw();
    });
    this.readouts.push(value);
    return entry;
  }

  // The values under the pointer, at the frame nearest to it.
  tell(event) {
    const t = this.timeAt(event), lines = [];
    let at = t;
    this.plot.curves.forEach((curve, i) => {
      if (this.hidden.has(i)) return;
      const k = curve.frameAt(t), n = Math.min(k + 1, curve.times.length - 1), near = t - curve.times[k] <= curve.times[n] - t ? k : n;
      at = curve.times[near];
      lines.push(html('div', {}, `${curve.name}: `, html('b', {}, `${valueInWords(curve, near, 6)} ${this.plot.unit}`)));
    });
    this.hover.hidden = this.tip.hidden = lines.length === 0;
    if (lines.length === 0) return;
    const share = this.x(at) / this.width, isRight = share > 0.55;
    this.hover.style.transform = `translateX(${(100 * share).toFixed(3)}%)`;
    this.tip.replaceChildren(html('div', {}, `${short(at, 6)} s`), ...lines.slice(0, 8));
    this.tip.style.left = isRight ? '' : `calc(${(100 * share).toFixed(2)}% + .5rem)`;
    this.tip.style.right = isRight ? `calc(${(100 * (1 - share)).toFixed(2)}% + .5rem)` : '';
  }

  // @param isFull  updates the numbers too, not only the cursor
  follow(t, isFull) {
    this.cursor.hidden = t < this.from - 1e-9 || t > this.until + 1e-9;
    this.cursor.style.transform = `translateX(${(100 * this.x(t) / this.width).toFixed(3)}%)`;
    if (!isFull) return;
    this.plot.curves.forEach((curve, i) => {
      this.readouts[i].textContent = `${valueInWords(curve, curve.frameAt(t))} ${this.plot.unit}`;
    });
  }
}
