// A run in the page: poses by body and frame, series, contacts, events. SI units, world frame; places from the page's
// origin, which is near them where they are far from the world's: single precision, too, draws them where they are.

// Times nearer to each other than this [s] are one instant: a ten-thousandth of the mean time between frames, and never
// more than a microsecond.
function sameInstant(times) {
  const between = times.length - 1;
  return between < 1 ? 1e-6 : Math.min(1e-6, 1e-4 * (times[between] - times[0]) / between);
}

const kEventNames = ['', 'collision', 'comes to rest', 'force on', 'force off', 'contact begins', 'contact ends', 'sticks', 'slides', 'falls asleep', 'wakes', 'control'];
const kCollision = 1;

class Run {
  // @param origin  of the page, in the world [m]
  constructor(head, bytes, origin = [0, 0, 0]) {
    this.head = head;
    this.origin = origin;
    this.isFar = origin.some(x => x !== 0);
    this.label = head.label;
    if (bytes) this.read(new ChannelReader(bytes));   // without: frames come later, from a run that goes on
  }

  read(reader) {
    const head = this.head, n = head.frames;
    this.times = reader.channel(n, Float64Array);
    this.moving = new Map();   // by body index
    for (const body of head.moving) {
      const channels = [];
      for (let i = 0; i < 13; ++i) channels.push(reader.channel(n));
      this.moving.set(body, channels);
    }
    this.resting = new Map(head.resting.map(entry => [entry.body, entry.pose]));
    this.series = head.series.map(entry => ({ ...entry, values: reader.channel(n, Float64Array) }));
    if (head.channelsOf !== undefined) this.series = this.series.filter(entry => entry.plot !== 'apart');   // the other run's
    this.readContacts(reader);
    this.readEvents(reader, head.events);
    this.findImpacts();
  }

  // Times of impacts, by body: between two frames with an impact the path is not straight.
  findImpacts() {
    const e = this.events;
    this.impacts = new Map();
    for (let i = 0; i < e.count; ++i)
      for (const body of e.kind[i] === kCollision ? [e.a[i], e.b[i]] : []) {
        if (!this.moving.has(body)) continue;
        if (!this.impacts.has(body)) this.impacts.set(body, []);
        this.impacts.get(body).push(e.time[i]);
      }
  }

  // Position of a body between two frames with impacts: along the velocity of the first frame up to
  // the first impact, along that of the second frame after the last impact, straight in between
  // (gravity within a frame is neglected: 1.4 mm at 60 Hz). @return false without impacts
  placeAroundImpacts(body, at, place) {
    const impacts = this.impacts.get(body), begin = this.times[at.k], end = this.times[at.k + 1];
    if (!impacts || at.part === 0) return false;
    let low = 0, high = impacts.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (impacts[middle] <= begin + 2e-6) low = middle + 1; else high = middle;
    }
    const first = impacts[low];
    if (!(first < end - 2e-6)) return false;
    let last = first;
    for (let i = low; i < impacts.length && impacts[i] < end - 2e-6; ++i) last = impacts[i];
    const c = this.moving.get(body), t = begin + at.part * (end - begin);
    const before = (i, time) => c[i][at.k] + c[7 + i][at.k] * (time - begin), after = (i, time) => c[i][at.k + 1] - c[7 + i][at.k + 1] * (end - time);
    const share = last > first ? (t - first) / (last - first) : 0;
    const one = i => (t <= first ? before(i, t) : t >= last ? after(i, t) : (1 - share) * before(i, first) + share * after(i, last));
    place.set(one(0), one(1), one(2));
    return true;
  }

  readContacts(reader) {
    const frames = Math.ceil(this.head.frames / this.head.contactStride), counts = reader.channel(frames);
    this.contactBegins = new Uint32Array(frames + 1);
    for (let i = 0; i < frames; ++i) this.contactBegins[i + 1] = this.contactBegins[i] + counts[i];
    this.contacts = [];
    for (let i = 0; i < 8; ++i) this.contacts.push(reader.channel(this.head.contacts));
  }

  readEvents(reader, count) {
    const kinds = [Float64Array, Uint8Array, Int32Array, Int32Array];
    const c = [];
    for (let i = 0; i < 13; ++i) c.push(reader.channel(count, kinds[i] || Float32Array));
    this.events = { count, time: c[0], kind: c[1], a: c[2], b: c[3], point: c.slice(4, 7), normal: c.slice(7, 10), impulse: c[10], before: c[11], after: c[12] };
  }

  get end() { return this.times[this.times.length - 1]; }

  // The last frame not later than t, and the fraction of the interval to the next.
  frameAt(t) {
    const times = this.times;
    const same = sameInstant(times);
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t + same) low = middle; else high = middle - 1;
    }
    if (low + 1 >= times.length) return { k: low, part: 0 };
    return { k: low, part: Math.min(1, Math.max(0, (t - times[low]) / (times[low + 1] - times[low]))) };
  }

  // Position and orientation between two frames. @return false where they are not finite
  pose(body, at, place, turn) {
    const c = this.moving.get(body), rest = this.resting.get(body);
    if (!c) {
      place.set(rest[0], rest[1], rest[2]);
      turn.set(rest[3], rest[4], rest[5], rest[6]);
      return true;
    }
    const k = at.k, u = at.part, n = Math.min(k + 1, this.times.length - 1), v = 1 - u;
    const sign = c[3][k] * c[3][n] + c[4][k] * c[4][n] + c[5][k] * c[5][n] + c[6][k] * c[6][n] < 0 ? -u : u;
    if (!this.placeAroundImpacts(body, at, place)) place.set(v * c[0][k] + u * c[0][n], v * c[1][k] + u * c[1][n], v * c[2][k] + u * c[2][n]);
    turn.set(v * c[3][k] + sign * c[3][n], v * c[4][k] + sign * c[4][n], v * c[5][k] + sign * c[5][n], v * c[6][k] + sign * c[6][n]).normalize();
    return Number.isFinite(place.x + place.y + place.z + turn.x + turn.w);
  }

  // Of places [m] in the world, as text: with more digits where they are far from its origin.
  placeInWords(values, digits) { return values.map((x, i) => (this.isFar ? allDigits(x + this.origin[i]) : short(x, digits))); }

  originInWords() { return `(${this.origin.map(allDigits).join(', ')}) m`; }

  // First event at or after a time.
  eventFrom(t) {
    const times = this.events.time;
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < t) low = middle + 1; else high = middle;
    }
    return low;
  }

  // Curves of one body, for the body pane.
  bodySeries(body) {
    const c = this.moving.get(body);
    if (!c) return [];
    const size = first => c[first].map((x, i) => Math.hypot(x, c[first + 1][i], c[first + 2][i]));
    const list = (plot, unit, names, channels) => names.map((name, i) => ({ plot, unit, name, values: channels[i] }));
    const places = list('place', 'm', ['x', 'y', 'z'], [c[0], c[1], c[2]]);
    if (this.isFar) places.forEach((series, i) => Object.assign(series, { offset: this.origin[i], from: this.originInWords() }));   // a curve of metres, not of a million
    return [...places,
            ...list('velocity', 'm/s', ['x', 'y', 'z', 'speed'], [c[7], c[8], c[9], size(7)]),
            ...list('omega', 'rad/s', ['x', 'y', 'z', 'size'], [c[10], c[11], c[12], size(10)])];
  }
}
