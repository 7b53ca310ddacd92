// The panes of curves: of the whole run, and of the chosen body. Each plot shows the time cursor,
// which can be dragged.

const kPlots = {
  apart: { title: 'Distance between the two runs', axis: 'distance', isLog: true },
  energy: { title: 'Energy', axis: 'energy' },
  drift: { title: 'Change of the total energy', axis: 'E − E(0)' },
  momentum: { title: 'Momentum of all movable bodies', axis: 'momentum' },
  spin: { title: 'Angular momentum about the origin', axis: 'ang. momentum' },
  gap: { title: 'Smallest gap between two bodies', axis: 'gap' },
  springs: { title: 'Spring forces (tension > 0)', axis: 'force', isChosen: true },
  rods: { title: 'Rod forces (tension > 0)', axis: 'tension', isChosen: true },
  joints: { title: 'Forces in joints', axis: 'force', isChosen: true },
  place: { title: 'Centre of mass', axis: 'position' },
  velocity: { title: 'Velocity', axis: 'velocity' },
  omega: { title: 'Angular velocity, world', axis: 'ω' },
};
const kMostFound = 30;   // bodies that are listed
const kMostLinks = 4;   // curves in one plot; with more links the user chooses one

function curvesOf(runs, pick) {
  const byPlot = new Map();
  runs.forEach((run, r) => {
    for (const series of pick(run)) {
      if (series.plot === 'apart' && !series.values.some(v => v > 0)) continue;   // equal throughout, which the page states above
      if (!byPlot.has(series.plot)) byPlot.set(series.plot, { ...kPlots[series.plot], unit: series.unit, curves: [] });
      if (series.from) byPlot.get(series.plot).heading = `${kPlots[series.plot].title}, drawn from ${series.from}`;
      const name = runs.length > 1 && series.plot !== 'apart' ? `${series.name}, ${run.label}` : series.name;
      byPlot.get(series.plot).curves.push({ name, link: series.name, run: r, times: run.times, values: series.values, offset: series.offset, frameAt: t => run.frameAt(t).k });
    }
  });
  return [...byPlot.values()].sort((a, b) => Object.values(kPlots).findIndex(p => p.title === a.title) - Object.values(kPlots).findIndex(p => p.title === b.title));
}

class CurvePane {
  constructor(box, player) {
    this.box = box;
    this.player = player;
    this.plots = [];
  }

  fill(plots) {
    this.box.textContent = '';
    this.plots = [];
    for (const plot of plots) {
      const links = [...new Set(plot.curves.map(curve => curve.link))];
      if (plot.isChosen && links.length > kMostLinks) this.addChoice(plot, links);
      else this.add(plot, this.box);
    }
    this.follow(this.player.time);
  }

  add(plot, box) {
    const made = new TimePlot(plot, this.player.end, t => this.player.seek(t), (factor, t) => this.player.zoom(factor, t));
    made.setWindow(this.player.from, this.player.until);
    this.plots.push(made);
    box.append(made.box);
    return made;
  }

  // One of many links: initially the one with the largest force.
  addChoice(plot, links) {
    const strength = name => Math.max(...plot.curves.filter(curve => curve.link === name).map(curve => curve.values.reduce((most, v) => Math.max(most, Math.abs(v) || 0), 0)));
    const strengths = links.map(strength), select = html('select', { ariaLabel: plot.title }), holder = html('div'), inner = html('div');
    links.forEach(name => select.append(html('option', { value: name }, name)));
    select.selectedIndex = strengths.indexOf(Math.max(...strengths));
    let shown = null;
    const show = () => {
      if (shown) this.plots.splice(this.plots.indexOf(shown), 1);
      inner.textContent = '';
      shown = this.add({ ...plot, curves: plot.curves.filter(curve => curve.link === select.value) }, inner);
      shown.follow(this.player.time, true);
    };
    select.addEventListener('change', show);
    holder.append(html('label', { className: 'choice' }, 'which: ', select), inner);
    this.box.append(holder);
    show();
  }

  follow(t, isFull = true) {
    for (const plot of this.plots) {
      plot.setWindow(this.player.from, this.player.until);
      plot.follow(t, isFull);
    }
  }
}

// Curves of the chosen body.
class BodyPane extends CurvePane {
  constructor(pane, player) {
    const box = html('div');
    super(box, player);
    this.finder = new BodyFinder(player);
    pane.append(this.finder.box, box);
    this.choose(player.chosen);
  }

  choose(body) {
    this.body = body;
    if (body < 0) {
      this.box.textContent = 'Choose a body: click it in the picture, or find it by its name.';
      this.plots = [];
      return;
    }
    const about = this.player.about.bodies[body];
    this.fill(curvesOf(this.player.runs, run => run.bodySeries(body)));
    const note = this.plots.length === 0 ? (about.immovable ? ' is immovable.' : ' never moves.') : '';
    this.box.prepend(html('h2', {}, about.name), ...(note ? [html('p', {}, about.name + note)] : []));
  }
}

// A field in which one types part of a body's name, and the bodies that have it in theirs. The
// return key chooses the first, and again the next.
class BodyFinder {
  constructor(player) {
    this.player = player;
    this.field = html('input', { type: 'search', placeholder: 'find a body', ariaLabel: 'Find a body by its name' });
    this.list = html('div', { className: 'found' });
    this.box = html('div', { className: 'finder' }, this.field, this.list);
    this.field.addEventListener('input', () => this.show());
    this.field.addEventListener('keydown', event => {
      if (event.key === 'Escape') { this.field.value = ''; this.show(); this.field.blur(); }
      if (event.key !== 'Enter') return;
      const found = this.found();
      if (found.length > 0) player.choose(found[(found.indexOf(player.chosen) + 1) % found.length]);
      this.show();
    });
  }

  found() {
    const words = this.field.value.trim().toLowerCase().split(/\s+/).filter(Boolean), all = this.player.about.bodies;
    return words.length === 0 ? [] : all.map((_, i) => i).filter(i => words.every(word => all[i].name.toLowerCase().includes(word)));
  }

  show() {
    const found = this.found();
    this.list.replaceChildren(...found.slice(0, kMostFound).map(i => {
      const button = html('button', {}, this.player.about.bodies[i].name);
      button.setAttribute('aria-pressed', String(i === this.player.chosen));
      button.addEventListener('click', () => keepFocus(this.list, () => { this.player.choose(i); this.show(); }));
      return button;
    }));
    if (this.field.value.trim()) this.list.append(html('span', { className: 'count' }, found.length === 0 ? 'no body has this in its name' : found.length > kMostFound ? `${found.length - kMostFound} more` : ''));
  }
}
