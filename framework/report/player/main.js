// Assembles the page. A part that fails says so in the page, and the rest stays usable.

function complain(text) {
  byId('complaint').textContent = text;
  byId('complaint').hidden = false;
  document.body.dataset.error = text;
}

window.addEventListener('error', event => complain(`This page's script failed: ${event.message}. Plots and events are below.`));
window.addEventListener('unhandledrejection', event => complain(`This page's script failed: ${event.reason && event.reason.message || event.reason}. Plots and events are below.`));

async function loadThree() {
  if (!byId('three') && !window.tumbleThree) throw new Error('three.js, which lies beside this page, is missing');
  const bytes = await openedBytes('three', byId('three') ? undefined : window.tumbleThree);
  document.head.append(html('script', { textContent: new TextDecoder().decode(bytes) }));
  if (typeof THREE === 'undefined' || !THREE.OrbitControls) throw new Error('three.js did not load');
}

// Whether WebGL is rendered in software, without a graphics card.
function drawsBySoftware() {
  const gl = document.createElement('canvas').getContext('webgl', { antialias: false }), info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const is = Boolean(info) && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
  if (gl && gl.getExtension('WEBGL_lose_context')) gl.getExtension('WEBGL_lose_context').loseContext();
  return is;
}

// The picture: one canvas with a view for each run, and one camera for all.
class Picture {
  constructor(player) {
    this.player = player;
    this.canvas = byId('picture');
    const isSoftware = drawsBySoftware();   // then antialiasing and shadows would take most of the time
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: !isSoftware });
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.setScissorTest(true);
    if (isSoftware) player.shown.shadows = false;
    this.ratio = this.fullRatio = this.playRatio = Math.min(2, window.devicePixelRatio || 1);
    this.stages = player.runs.map(run => new Stage(player.about, run, player.runs));
    const first = this.stages[0];
    this.camera = new THREE.PerspectiveCamera(player.about.camera.fov, 1, 0.01 * first.sight, 40 * first.sight + 2 * first.extent.getSize(new THREE.Vector3()).length());
    this.camera.up.set(0, 0, 1);
    this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
    this.orbit.enableKeys = false;
    this.orbit.screenSpacePanning = true;
    this.orbit.addEventListener('change', () => { this.isDirty = true; });
    player.listeners.push(() => { this.isDirty = true; });
    new ResizeObserver(() => { this.resize(); this.draw(); }).observe(byId('scene'));   // a canvas of a new size is empty until it is drawn
    this.triad = new Triad();
    this.addPicking();
    this.reset();
    this.resize();
  }

  // From another side, at the same distance; or so that all bodies, or the chosen one, fill the
  // picture.
  look(name) {
    const { from, of } = kLooks[name], first = this.stages[0], now = this.camera.position.clone().sub(this.orbit.target);
    if (of === 'scene') return this.reset();
    let distance = now.length();
    const box = of === 'all' ? first.extent.clone() : new THREE.Box3(), chosen = this.player.about.bodies[this.player.chosen];
    if (of === 'body' && chosen && chosen.radius !== null) {
      const r = Math.max(chosen.radius, 0.01 * first.sight);
      box.setFromCenterAndSize(first.placeOf(this.player.chosen, this.player.time), new THREE.Vector3(2 * r, 2 * r, 2 * r));
    }
    if (of && box.isEmpty()) return;
    if (of) {
      this.orbit.target.copy(box.getCenter(new THREE.Vector3()));
      distance = 0.5 * box.getSize(new THREE.Vector3()).length() / Math.sin(this.player.about.camera.fov * Math.PI / 360);
    }
    const direction = from ? new THREE.Vector3(...from) : now.normalize();
    this.camera.position.copy(this.orbit.target).addScaledVector(direction.normalize(), distance);
    this.camera.near = Math.min(this.camera.near, 0.01 * distance);
    this.orbit.update();
    this.isDirty = true;
  }

  reset() {
    const about = this.player.about, first = this.stages[0];
    this.camera.position.copy(first.eye);
    this.orbit.target.copy(first.target);
    // For a vertical line of sight y is up: the camera's up direction must not be parallel to its
    // line of sight.
    if (Math.hypot(first.eye.x - first.target.x, first.eye.y - first.target.y) < 1e-6 * first.sight) this.camera.position.y -= 1e-3 * first.sight;
    this.followedAt = null;
    if (about.camera.follow >= 0 && this.player.followed < 0) {
      this.player.chosen = this.player.followed = about.camera.follow;
      this.followedAt = first.placeOf(about.camera.follow, 0);
    }
    this.orbit.update();
    this.player.changed();
  }

  // The views of the runs: one, with the second run as a ghost; or, on request, side by side or one
  // below the other, whichever gives the larger 4:3 picture. Fractions of the canvas, y down.
  views() {
    if (!this.player.shown.beside) return this.stages.map(() => ({ x: 0, y: 0, w: 1, h: 1 }));
    const count = this.stages.length, size = (w, h) => Math.min(h, 0.75 * w);
    const beside = size(this.width / count, this.height) >= size(this.width, this.height / count);
    return this.stages.map((_, r) => (beside ? { x: r / count, y: 0, w: 1 / count, h: 1 } : { x: 0, y: r / count, w: 1, h: 1 / count }));
  }

  resize() {
    const box = byId('scene'), width = Math.max(1, box.clientWidth), height = Math.max(1, box.clientHeight);
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(width, height, false);
    this.width = width;
    this.height = height;
    this.isDirty = true;
  }

  // The camera follows the chosen body.
  follow() {
    const body = this.player.followed;
    if (body !== this.following) { this.followedAt = this.following === undefined ? this.followedAt : null; this.following = body; }
    if (body < 0) return;
    const now = this.stages[0].placeOf(body, this.player.time);
    if (!this.followedAt) this.followedAt = now.clone();   // from here on
    const shift = now.clone().sub(this.followedAt);
    if (!Number.isFinite(shift.x)) return;
    this.camera.position.add(shift);
    this.orbit.target.add(shift);
    this.followedAt.copy(now);
    this.orbit.update();
  }

  draw() {
    this.isDirty = false;
    const { player, stages, renderer, camera } = this, views = this.views();
    this.follow();
    // A whole 4:3 picture is visible, however narrow the view.
    const half = Math.tan(player.about.camera.fov * Math.PI / 360), aspect = views[0].w * this.width / (views[0].h * this.height);
    camera.fov = 2 * Math.atan(half * Math.max(1, 4 / 3 / aspect)) * 180 / Math.PI;
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
    const pixels = 0.5 * views[0].h * this.height * this.ratio / (Math.tan(camera.fov * Math.PI / 360) * camera.position.distanceTo(this.orbit.target));
    stages.forEach((stage, r) => {
      const isGhost = r > 0 && !player.shown.beside;
      stage.haunt(isGhost);
      renderer.autoClear = !isGhost;
      if (stage.chosen !== player.chosen) stage.choose(player.chosen);
      stage.key.castShadow = player.shown.shadows && !isGhost;
      stage.refine(pixels);
      stage.show(Math.min(player.time, stage.run.end), player.speed, player.shown);
      const view = views[r], width = view.w * this.width, height = view.h * this.height, left = view.x * this.width, below = this.height - view.y * this.height - height;
      renderer.setViewport(left, below, width, height);
      renderer.setScissor(left, below + (view.y + view.h < 1 ? 2 : 0), width - (view.x + view.w < 1 ? 2 : 0), height - (view.y + view.h < 1 ? 2 : 0));
      const shift = r > 0 && player.followed >= 0 ? stage.placeOf(player.followed, player.time).sub(stages[0].placeOf(player.followed, player.time)) : null;
      if (shift) camera.position.add(shift);
      renderer.render(stage.scene, camera);
      if (shift) camera.position.sub(shift);
    });
    if (player.shown.triad) this.triad.draw(renderer, camera, this.orbit.target);
  }

  addPicking() {
    let down = null;
    this.canvas.addEventListener('pointerdown', event => { down = [event.clientX, event.clientY]; });
    this.canvas.addEventListener('pointerup', event => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5 || event.button !== 0) return;
      const box = this.canvas.getBoundingClientRect(), x = (event.clientX - box.left) / box.width, y = (event.clientY - box.top) / box.height;
      const r = Math.max(0, this.views().findIndex(v => x >= v.x && x < v.x + v.w && y >= v.y && y < v.y + v.h)), view = this.views()[r];
      const spot = new THREE.Vector3(2 * (x - view.x) / view.w - 1, 1 - 2 * (y - view.y) / view.h, 0.5).unproject(this.camera);
      this.player.choose(this.stages[r].pick(this.camera.position.clone(), spot.sub(this.camera.position).normalize(), Math.min(this.player.time, this.stages[r].run.end)));
    });
  }

  // If the frame rate stays below 25 Hz for a while, shadows are switched off first, then the full
  // pixel resolution.
  adapt(milliseconds) {
    this.times = milliseconds > 500 ? [] : [...(this.times || []), milliseconds].slice(-20);
    const sum = this.times.reduce((a, b) => a + b, 0);
    if (sum < 600 || sum / this.times.length < 40) return;
    this.times = [];
    if (this.player.shown.shadows) {
      this.player.shown.shadows = false;
      const box = [...document.querySelectorAll('#options label')].find(label => label.textContent.includes('shadows'));
      if (box) box.querySelector('input').checked = false;
    } else if (this.ratio > 0.6) {
      this.ratio = this.playRatio = Math.max(0.5, 0.7 * this.ratio);
      this.resize();
    }
  }

  // A picture that stands still is drawn with all pixels.
  sharpen(isPlaying) {
    const ratio = isPlaying ? this.playRatio : this.fullRatio;
    if (ratio === this.ratio) return;
    this.ratio = ratio;
    this.resize();
  }
}

function addTabs(player) {
  const panes = [['Curves', box => { const pane = new CurvePane(box, player); pane.fill(curvesOf(player.runs, run => run.series)); return pane; }],
    ['Body', box => new BodyPane(box, player)], [`Events (${player.runs.reduce((sum, run) => sum + run.events.count, 0)})`, box => new EventPane(box, player)]];
  for (const panel of player.about.panels)
    if (panelKinds[panel.kind]) panes.push([panel.title, box => { const made = panelKinds[panel.kind](box, panel.data, player); return { follow: (t, isFull) => isFull && made.at(t) }; }]);
  const tabs = panes.map(([title, make], i) => {
    const tab = html('button', { role: 'tab', id: `tab${i}` }, title), box = html('div', { role: 'tabpanel', className: 'pane', tabIndex: 0 });
    box.setAttribute('aria-labelledby', `tab${i}`);
    tab.setAttribute('role', 'tab');
    byId('tabs').append(tab);
    byId('panes').append(box);
    return { tab, box, make, pane: null };
  });
  let chosen = player.chosen;
  const open = at => {
    tabs.forEach((entry, i) => { entry.tab.setAttribute('aria-selected', String(i === at)); entry.box.hidden = i !== at; });
    tabs[at].pane = tabs[at].pane || tabs[at].make(tabs[at].box);
    update();
  };
  const update = () => {
    const isNew = player.chosen !== chosen;
    chosen = player.chosen;
    if (isNew && chosen >= 0 && !tabs[0].box.hidden) return open(1);   // show the curves of a newly chosen body
    for (const { pane, box } of tabs) {
      if (!pane || box.hidden) continue;
      if (pane.choose && pane.body !== chosen) pane.choose(pane.body = chosen);
      pane.follow(player.time, player.isTimeToTell());
    }
  };
  tabs.forEach((entry, i) => entry.tab.addEventListener('click', () => open(i)));
  player.listeners.push(update);
  open(0);
  oneStop(byId('tabs'), 'aria-selected');
  const find = () => {
    open(1);
    tabs[1].pane.finder.field.focus();
  };
  return { open, find, names: tabs.map(entry => entry.tab.textContent) };
}

// The arrows of the picture in words: the latest impact, and active forces.
function happeningIn(player, run) {
  const e = run.events, i = run.eventFrom(player.time + 1e-5) - 1, names = player.about.bodies, words = [];
  if (i >= 0 && player.time - e.time[i] < kFlashSeconds * player.speed && e.kind[i] === kCollision)
    words.push(`${[e.a[i], e.b[i]].filter(b => b >= 0).map(b => names[b].name).join(' – ')}: ${short(e.impulse[i], 3)} N s, ${short(e.before[i], 3)} → ${short(e.after[i], 3)} m/s`);
  for (const push of player.about.forces)
    if (player.time >= push.start - sameInstant(run.times) && player.time <= push.start + push.duration) words.push(`force on ${names[push.body].name}: ${short(Math.hypot(...push.force), 3)} N`);
  return words.join(' · ');
}

// What a run stopped by may list a call's arguments, which would cover the picture: below it they are told whole.
function firstLine(text) { return text.split('\n', 1)[0]; }

function addWords(player, picture) {
  const labels = [];
  player.runs.forEach((run, r) => {
    const laws = ['scheduler', 'impulses', 'motion', 'constraints']
                     .filter(what => run.head[what] && run.head[what] !== 'none')
                     .map(what => `${what}: ${run.head[what]}`);
    const now = html('p', { className: 'now' });
    const box = html('div', { className: 'label' }, html('b', {}, run.label || ''), html('i', {}, ' (ghost)'), html('span', {}, run.head.stopped ? ` stopped: ${firstLine(run.head.stopped)}` : ''),
      html('span', {}, run.head.faults ? ` cannot be trusted: ${run.head.faults}` : ''), now);
    player.listeners.push(() => { if (player.isTimeToTell()) now.textContent = happeningIn(player, run); });
    labels.push(box);
    if (run.head.stopped && run.head.stopped.includes('\n'))
      byId('difference')
          .after(html(
              'details', {className: 'stopped'},
              html('summary', {}, `By what ${run.label || 'the run'} was stopped`),
              html('pre', {}, run.head.stopped)));
    box.title = `engine ${run.head.engine}, step ${short(run.head.step)} s; ${laws.join('; ')}`;
    byId('words').append(box);
  });
  const place = () => (picture ? picture.views() : player.runs.map((_, r) => ({ x: r / player.runs.length, y: 0 }))).forEach((view, r) => {
    const isGhost = picture && r > 0 && !player.shown.beside;
    labels[r].style.left = `${100 * view.x}%`;
    labels[r].style.top = isGhost ? `calc(.7rem + ${labels[0].offsetHeight}px)` : `calc(${100 * view.y}% + .4rem)`;
    labels[r].classList.toggle('ghost', Boolean(isGhost));
  });
  new ResizeObserver(place).observe(byId('scene'));
  player.listeners.push(() => { if (player.isTimeToTell()) place(); });
  place();
  const notes = [];
  if (picture && picture.stages[0].spacing) notes.push(`grid ${short(picture.stages[0].spacing)} m`);
  if (player.runs[0].isFar) notes.push(`drawn from ${player.runs[0].originInWords()}`);
  for (const run of player.runs) if (run.head.stride > 1) notes.push(`one of ${run.head.stride} frames kept`);
  byId('words').append(html('div', { className: 'note' }, notes.join(' · ')));
}

function readHash(player, tabs) {
  const words = new URLSearchParams(location.hash.slice(1));
  if (words.has('bare')) {
    document.body.classList.add('bare');
    player.shown.triad = false;
  }
  if (words.has('body')) player.choose(player.about.bodies.findIndex(body => body.name === words.get('body')));
  if (words.has('follow')) player.follow(true);
  if (words.has('tab')) tabs.open(Math.max(0, tabs.names.findIndex(name => name.toLowerCase().startsWith(words.get('tab')))));
  if (words.has('speed')) player.setSpeed(Number(words.get('speed')) || 1);
  if (words.has('t')) player.goTo(Number(words.get('t')));
  else if (!window.matchMedia('(prefers-reduced-motion: reduce)').matches) player.play();
}

function runLoop(player, picture) {
  let frames = 0, since, lastTime;
  const loop = now => {
    player.tick(now);
    if (picture) picture.sharpen(player.isPlaying);
    if (picture && picture.isDirty) {
      picture.draw();
      if (player.isPlaying && lastTime !== undefined) picture.adapt(now - lastTime);
    }
    lastTime = now;
    if (!player.isPlaying) since = undefined;
    else if (since === undefined) [since, frames] = [now, 0];
    else if (++frames && now - since > 1000) {
      document.body.dataset.fps = (frames * 1000 / (now - since)).toFixed(1);
      [since, frames] = [now, 0];
    }
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
}

async function main() {
  const element = byId('about-run'), isText = element.type === 'application/json';
  const about = JSON.parse(isText ? element.textContent : new TextDecoder().decode(await openedBytes('about-run')));
  const runs = await Promise.all(about.runs.map(async (head, r) => new Run(head, await openedBytes(`run${head.channelsOf ?? r}`), about.origin)));
  const player = new Player(about, runs);
  byId('player').hidden = byId('side').hidden = false;
  let picture = null;
  try {
    await loadThree();
    picture = new Picture(player);
    byId('complaint').hidden = true;
  } catch (error) {
    complain(`The motion cannot be drawn here (${error.message}). Curves and events work.`);
    document.body.classList.add('flat');
  }
  const tabs = addTabs(player);
  new Controls(player, picture, () => tabs.find());
  addWords(player, picture);
  byId('still').hidden = true;
  readHash(player, tabs);
  if (picture) picture.draw();
  document.body.dataset.ready = performance.now().toFixed(0);
  window.tumble = { player, picture, files: { tableText, gltfBytes, pictureBlob, videoBlob } };   // for the browser's console
  runLoop(player, picture);
}

main().catch(error => {
  document.documentElement.classList.remove('alive');
  complain(`This page's script failed: ${error.message}. Plots and events are below.`);
});
