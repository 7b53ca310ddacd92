// The list of events of all runs, in order of time; only visible rows exist as elements. A click
// goes to the event.

const kRow = 26;   // px
const kSameInstant = 2e-6;   // s
const kOften = new Set([1, 5, 6, 7, 8]);   // kinds that may come by the thousand without an impulse: collision, contact begins and ends, sticks, slides

class EventPane {
  constructor(box, player) {
    this.player = player;
    this.all = [];
    player.runs.forEach((run, r) => {
      for (let i = 0; i < run.events.count; ++i) this.all.push({ r, i, time: run.events.time[i] });
    });
    this.all.sort((a, b) => a.time - b.time || a.r - b.r || a.i - b.i);
    this.kind = html('select', { ariaLabel: 'which events' });
    this.kind.append(html('option', { value: '0' }, 'all events'));
    const kinds = new Set(this.all.map(({ r, i }) => player.runs[r].events.kind[i]));
    [...kinds].sort((a, b) => a - b).forEach(k => this.kind.append(html('option', { value: String(k) }, kEventNames[k])));
    this.ofBody = html('input', { type: 'checkbox' });
    const idle = this.all.filter(entry => this.isIdle(entry)).length;
    this.isFolded = idle > 0 && idle < this.all.length;
    this.idle = html('input', { type: 'checkbox', checked: !this.isFolded });
    this.count = html('span', { className: 'count' });
    this.list = html('div', { className: 'events', tabIndex: 0, role: 'listbox', ariaLabel: 'Events: up and down arrows go through them' });
    this.list.style.setProperty('--run', `${Math.min(16, Math.max(...player.runs.map(run => (run.label || '').length)))}ch`);   // so that the fields after it are aligned
    this.sheet = html('div', { className: `sheet${player.runs.length > 1 ? ' both' : ''}` });
    this.list.append(this.sheet);
    box.append(html('div', { className: 'filter' }, this.kind, html('label', {}, this.ofBody, ' of the chosen body'),
      ...(this.isFolded ? [html('label', {}, this.idle, ` ${idle} without impulse`)] : []), this.count), this.list);
    for (const control of [this.kind, this.ofBody, this.idle]) control.addEventListener('change', () => this.filter());
    this.list.addEventListener('scroll', () => this.draw());
    this.list.addEventListener('keydown', event => this.key(event));
    new ResizeObserver(() => this.draw()).observe(this.list);
    this.filter();
  }

  isIdle({ r, i }) {
    const e = this.player.runs[r].events;
    return kOften.has(e.kind[i]) && !(e.impulse[i] > 0);
  }

  filter() {
    const kind = Number(this.kind.value), body = this.ofBody.checked ? this.player.chosen : -1;
    this.rows = this.all.filter(({ r, i }) => {
      const e = this.player.runs[r].events;
      return (this.idle.checked || !this.isIdle({ r, i })) && (kind === 0 || e.kind[i] === kind) && (body < 0 || e.a[i] === body || e.b[i] === body);
    });
    this.count.textContent = `${this.rows.length} of ${this.all.length}`;
    this.sheet.style.height = `${this.rows.length * kRow}px`;
    this.current = undefined;
    this.follow(this.player.time);
    this.draw();
  }

  choose() { if (this.ofBody.checked) this.filter(); }

  text({ r, i }) {
    const run = this.player.runs[r], e = run.events, names = this.player.about.bodies;
    const bodies = [e.a[i], e.b[i]].filter(b => b >= 0).map(b => names[b].name).join(' – ');
    const speeds = Number.isFinite(e.before[i]) && e.kind[i] === kCollision ? `${short(e.before[i], 3)} → ${short(e.after[i], 3)} m/s` : '';
    return [e.time[i].toFixed(Math.max(4, decimalsOf(this.player.end))), this.player.runs.length > 1 ? run.label : '', kEventNames[e.kind[i]], bodies, e.impulse[i] > 0 ? `${short(e.impulse[i], 3)} N s` : '', speeds];
  }

  draw() {
    const first = Math.max(0, Math.floor(this.list.scrollTop / kRow) - 4), last = Math.min(this.rows.length, first + Math.ceil(this.list.clientHeight / kRow) + 8);
    this.sheet.textContent = '';
    for (let row = first; row < last; ++row) {
      const entry = this.rows[row], [time, label, kind, bodies, impulse, speeds] = this.text(entry);
      const button = html('button', { className: 'event' + (row === this.current ? ' now' : '') + (entry.r ? ' second' : ''), title: [bodies, impulse, speeds && `along the normal: ${speeds}`].filter(Boolean).join(', ') },
        html('span', { className: 'time' }, `${time} s`), ...(label ? [html('span', { className: 'run' }, label)] : []), html('span', { className: 'kind' }, kind), html('span', { className: 'bodies' }, bodies), html('span', { className: 'impulse' }, impulse));
      button.style.top = `${row * kRow}px`;
      button.id = `event${row}`;
      button.tabIndex = -1;   // the list is one stop of the keyboard
      button.setAttribute('role', 'option');
      button.setAttribute('aria-selected', String(row === this.current));
      button.addEventListener('click', () => { this.list.focus({ preventScroll: true }); this.goTo(row); });
      this.sheet.append(button);
    }
    if (this.current >= first && this.current < last) this.list.setAttribute('aria-activedescendant', `event${this.current}`);
    else this.list.removeAttribute('aria-activedescendant');
    if (this.rows.length === 0) this.sheet.append(html('p', { className: 'none' }, 'None.'));
  }

  goTo(row) {
    this.player.goTo(this.rows[row].time);
    this.current = row;   // of several at this instant
    this.reveal(row);
  }

  key(event) {
    const last = this.rows.length - 1, to = { ArrowDown: this.current + 1, ArrowUp: this.current - 1, Home: 0, End: last }[event.key];
    if (to === undefined || last < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    this.goTo(Math.min(last, Math.max(0, to)));
    event.preventDefault();
    event.stopPropagation();
  }

  reveal(row) {
    const top = Math.max(0, row) * kRow;
    if (top < this.list.scrollTop || top > this.list.scrollTop + this.list.clientHeight - kRow) this.list.scrollTop = Math.max(0, top - this.list.clientHeight / 2);
    this.draw();
  }

  // The last past event is highlighted and kept visible.
  follow(t, isFull = true) {
    if (!isFull || (this.rows[this.current] && Math.abs(this.rows[this.current].time - t) <= kSameInstant)) return;
    let low = 0, high = this.rows.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.rows[middle].time <= t + kSameInstant) low = middle + 1; else high = middle;
    }
    if (low - 1 === this.current) return;
    this.current = low - 1;
    const top = Math.max(0, this.current) * kRow;
    if (!this.list.matches(':hover') && (top < this.list.scrollTop + kRow || top > this.list.scrollTop + this.list.clientHeight - 3 * kRow))
      this.list.scrollTop = Math.max(0, top - this.list.clientHeight / 2);
    this.draw();
  }
}
