// Files that a reader takes along: the picture, a video, a table of the curves, bodies and their
// motion.

const kVideoRate = 30;   // pictures a second

function fileName(player, ending) {
  return `${(document.title || 'tumble').replace(/[^\w.-]+/g, '_').replace(/^_+|_+$/g, '').slice(0, 60)}${player.isZoomed || ending === 'png' ? `_${player.time.toFixed(3)}s` : ''}.${ending}`;
}

function offer(blob, name) {
  const link = html('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

// The picture with all pixels, in the task in which it was drawn: afterwards it is gone.
function pictureBlob(picture) {
  picture.sharpen(false);
  picture.draw();
  return new Promise(done => picture.canvas.toBlob(done, 'image/png'));
}

async function savePicture(player, picture) { offer(await pictureBlob(picture), fileName(player, 'png')); }

// ---- Video

function canRecord() { return typeof MediaRecorder === 'function' && Boolean(HTMLCanvasElement.prototype.captureStream); }

// Plays the shown part of time once and records what the picture shows meanwhile. @return a promise of the video
function videoBlob(player, picture, isOver = () => false) {
  const kinds = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'], kind = kinds.find(k => MediaRecorder.isTypeSupported(k));
  const recorder = new MediaRecorder(picture.canvas.captureStream(kVideoRate), { mimeType: kind, videoBitsPerSecond: 8e6 }), parts = [], { until } = player, isLooped = player.shown.loop;
  recorder.addEventListener('dataavailable', event => parts.push(event.data));
  return new Promise(done => {
    recorder.addEventListener('stop', () => done(new Blob(parts, { type: 'video/webm' })));
    player.shown.loop = false;
    player.goTo(player.from);
    player.play();
    recorder.start();
    const look = () => {
      if (player.isPlaying && player.time < until - 1e-9 && !isOver()) return requestAnimationFrame(look);
      player.pause();
      player.shown.loop = isLooped;
      setTimeout(() => recorder.stop(), 1000 / kVideoRate);   // with the last picture
    };
    requestAnimationFrame(look);
  });
}

async function recordVideo(player, picture, button) {
  if (button.dataset.recording) { button.dataset.recording = 'over'; return; }
  const text = button.textContent;
  button.dataset.recording = 'now';
  button.textContent = 'Stop recording';
  try {
    offer(await videoBlob(player, picture, () => button.dataset.recording === 'over'), fileName(player, 'webm'));
  } finally {
    delete button.dataset.recording;
    button.textContent = text;
  }
}

// ---- Table

function csvField(value) {
  if (typeof value === 'number') return Number.isFinite(value) ? String(value) : '';
  return /[",\n]/.test(value) ? `"${value.replace(/"/g, '""')}"` : value;
}

// A line a frame: all curves of the run, and place, orientation (x, y, z, w), velocity and angular velocity of the chosen body. Of two
// runs one below the other, the first column says which.
function tableText(player) {
  const { runs, chosen, about } = player, lines = [], isOfTwo = runs.length > 1;
  const series = new Map();   // heading -> a column of each run
  runs.forEach((run, r) => {
    const put = (heading, values) => series.set(heading, Object.assign(series.get(heading) || [], { [r]: values }));
    for (const one of run.series) put(`${one.plot}: ${one.name} [${one.unit}]`, one.values);
    const channels = run.moving.get(chosen), name = chosen >= 0 ? about.bodies[chosen].name : '';
    const kinds = ['x [m]', 'y [m]', 'z [m]', 'qx', 'qy', 'qz', 'qw', 'vx [m/s]', 'vy [m/s]', 'vz [m/s]', 'wx [rad/s]', 'wy [rad/s]', 'wz [rad/s]'];
    if (channels) channels.forEach((values, i) => put(`${name}: ${kinds[i]}`, i < 3 && run.isFar ? Array.from(values, x => x + run.origin[i]) : values));
  });
  lines.push([...(isOfTwo ? ['run'] : []), 'time [s]', ...series.keys()].map(csvField).join(','));
  runs.forEach((run, r) => {
    for (let k = 0; k < run.times.length; ++k)
      lines.push([...(isOfTwo ? [run.label] : []), run.times[k], ...[...series.values()].map(column => (column[r] ? Number(column[r][k]) : NaN))].map(csvField).join(','));
  });
  return lines.join('\n') + '\n';
}

function saveTable(player) { offer(new Blob([tableText(player)], { type: 'text/csv' }), fileName(player, 'csv')); }

// ---- glTF, by three.js's exporter

// The first run: a node a body, which keeps its name and moves as an animation; y is up in glTF, so all lie in a node that turns z there,
// and in one at the page's origin, from which single precision holds their places.
function gltfBytes(player, picture) {
  const { about } = player, stage = picture.stages[0], { run } = stage, root = new THREE.Group(), origin = new THREE.Group(), tracks = [], place = new THREE.Vector3(), turn = new THREE.Quaternion();
  root.name = document.title;
  root.rotation.x = -Math.PI / 2;
  origin.position.set(...run.origin);
  if (run.isFar) root.add(origin);
  about.bodies.forEach((body, i) => {
    const color = new THREE.Color(...colorOf(body, i)), glass = body.immovable ? stage.isGlass(i) : 0;
    const material = new THREE.MeshStandardMaterial({ color, roughness: 0.8, metalness: 0, vertexColors: THREE.VertexColors, transparent: glass > 0, opacity: glass || 1 });
    const mesh = new THREE.Mesh(geometryOf(body.shape, about.meshes, !body.immovable && body.shape.kind === 'sphere' && body.shape.radius > 0, 24), material);
    mesh.name = body.name;
    mesh.scale.copy(stage.scales[i]);
    run.pose(i, { k: 0, part: 0 }, mesh.position, mesh.quaternion);
    (run.isFar ? origin : root).add(mesh);
    if (!run.moving.has(i)) return;
    const times = [], places = [], turns = [], last = new THREE.Quaternion();
    for (let k = 0; k < run.times.length; ++k) {
      const time = Math.fround(run.times[k]);   // as the file has it, where times must increase
      if (times.length > 0 && !(time > times[times.length - 1])) continue;
      if (!run.pose(i, { k, part: 0 }, place, turn)) break;
      if (k > 0 && last.dot(turn) < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);   // the shorter way between two frames
      last.copy(turn);
      times.push(time);
      places.push(...place.toArray());
      turns.push(turn.x, turn.y, turn.z, turn.w);
    }
    tracks.push(new THREE.VectorKeyframeTrack(`${mesh.uuid}.position`, times, places), new THREE.QuaternionKeyframeTrack(`${mesh.uuid}.quaternion`, times, turns));
  });
  root.updateMatrixWorld(true);
  const clip = new THREE.AnimationClip('motion', run.end, tracks);
  return new Promise(done => new THREE.GLTFExporter().parse(root, done, { binary: true, animations: tracks.length > 0 ? [clip] : [], onlyVisible: false, trs: true }));
}

async function saveGltf(player, picture) { offer(new Blob([await gltfBytes(player, picture)], { type: 'model/gltf-binary' }), fileName(player, 'glb')); }
