// A module of WebAssembly (framework/modules/in_page.h) as functions from bytes to bytes.
// Runs in a worker of the page, and in node for tests. The module is a stranger's: it gets its own
// memory and the functions below, and what it answers is read with its length checked.

// Why a call, or a run, ended without an answer.
class Ended extends Error {
  constructor(kind, name, words) {
    super(words);
    this.kind = kind;   // 'not attempted', 'threw', 'crashed', 'wrong', 'out of time'
    this.name_ = name;  // of the function that was called
  }
}

const largestMessage = 1 << 20;   // bytes of an answer
const utf8 = new TextDecoder();

// Numbers one after the other, little-endian, as modules/wire.h has them.
class Writer {
  constructor() { this.view = new DataView(new ArrayBuffer(1024)); this.length = 0; }
  room(bytes) {
    if (this.length + bytes > this.view.byteLength) {
      const larger = new Uint8Array(2 * (this.length + bytes));
      larger.set(this.bytes());
      this.view = new DataView(larger.buffer);
    }
    const at = this.length;
    this.length += bytes;
    return at;
  }
  u32(n) { this.view.setUint32(this.room(4), n, true); return this; }
  i32(n) { this.view.setInt32(this.room(4), n, true); return this; }
  f64(x) { this.view.setFloat64(this.room(8), x, true); return this; }
  // a column of Eigen
  vector(v) { this.u32(v.length).u32(1); for (const x of v) this.f64(x); return this; }
  // rows of numbers; Eigen stores columns
  matrix(rows) {
    this.u32(rows.length).u32(rows.length === 0 ? 0 : rows[0].length);
    for (let j = 0; rows.length > 0 && j < rows[0].length; ++j) for (const row of rows) this.f64(row[j]);
    return this;
  }
  quaternion([w, x, y, z]) { return this.f64(x).f64(y).f64(z).f64(w); }
  bytes() { return new Uint8Array(this.view.buffer, 0, this.length); }
}

class Reader {
  constructor(bytes) { this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength); this.at = 0; }
  step(bytes) {
    if (this.at + bytes > this.view.byteLength) throw new Error('the answer ends inside a value');
    this.at += bytes;
    return this.at - bytes;
  }
  u8() { return this.view.getUint8(this.step(1)); }
  u32() { return this.view.getUint32(this.step(4), true); }
  i32() { return this.view.getInt32(this.step(4), true); }
  f64() { return this.view.getFloat64(this.step(8), true); }
  vector() {
    const rows = this.u32(), columns = this.u32();
    if (columns !== 1 || 8 * rows > this.view.byteLength - this.at) throw new Error('a vector of an impossible size');
    return Array.from({ length: rows }, () => this.f64());
  }
}

class Law {
  // @param hears  called with a function's name before it is called, may be empty
  constructor(bytes, hears = () => {}) {
    this.hears = hears;
    this.module = new WebAssembly.Module(bytes);
    this.functions = [];   // that the module may call back: bytes to bytes
    this.thrown = null;
    this.begin();
  }

  // A fresh memory: after a call that ended early, and before a run.
  begin() {
    const nothingThere = 52;   // WASI's ENOSYS
    const stop = () => { throw new Ended('crashed', this.called, 'it ended the program'); };
    const imports = {
      tumble: {
        threw: (kind, text, length) => { throw this.thrown_(kind, text, length); },
        callback: (which, text, length) => this.back_(which, text, length),
      },
      wasi_snapshot_preview1: new Proxy({}, { get: (_, name) => name === 'proc_exit' ? stop : () => nothingThere }),
    };
    this.instance = null;
    this.called = 'the start of the module';
    this.instance = new WebAssembly.Instance(this.module, imports);
    this.guarded_(() => this.instance.exports._initialize?.());
    const length = this.guarded_(() => this.instance.exports.tumble_names());
    this.names = utf8.decode(this.answer_(length)).trim().split(' ');
  }

  memory_(at, length) {
    const memory = this.instance.exports.memory.buffer;
    at >>>= 0;
    length >>>= 0;
    if (length > largestMessage || at + length > memory.byteLength) throw new Ended('wrong', this.called, 'its answer has an impossible size');
    return new Uint8Array(memory, at, length);
  }
  answer_(length) { return this.memory_(this.guarded_(() => this.instance.exports.tumble_answer()), length).slice(); }

  thrown_(kind, text, length) {
    const words = utf8.decode(this.memory_(text, Math.min(length >>> 0, 500)));
    if (kind === 0) return new Ended('not attempted', this.called, `it is not implemented; hints: ${words}`);
    if (kind === 3) return new Ended('wrong', this.called, words);
    return new Ended('threw', this.called, kind === 2 ? `it threw an object of type ${words}` : `it threw: ${words}`);
  }

  back_(which, at, length) {
    const f = this.functions[which];
    if (f === undefined) throw new Ended('wrong', this.called, 'it calls a function that it was not given');
    const answer = f(this.memory_(at, length).slice());
    const room = this.instance.exports.tumble_room(answer.length);
    new Uint8Array(this.instance.exports.memory.buffer).set(answer, room >>> 0);
  }

  // A trap is a crash of the module; it begins anew.
  guarded_(call) {
    try {
      return call();
    } catch (error) {
      if (error instanceof Ended) throw error;
      const is_stack = error instanceof RangeError;
      throw new Ended('crashed', this.called, is_stack ? 'its calls are nested too deep' : `it crashed (${error.message})`);
    }
  }

  // @param writer  holds the arguments
  // @return the answer's bytes. @throws Ended
  bytes(name, writer, functions = []) {
    const number = this.names.indexOf(name);
    if (number < 0) throw new Ended('wrong', name, 'the module does not have it');
    this.hears(name);
    const outer = [this.called, this.functions];   // of a call that is being answered: a callback may call
    [this.called, this.functions] = [name, functions];
    try {
      const answer = this.guarded_(() => {
        const { tumble_room, tumble_call, memory } = this.instance.exports;
        const room = tumble_room(writer.length) >>> 0;
        new Uint8Array(memory.buffer).set(writer.bytes(), room);
        return this.answer_(tumble_call(number));
      });
      [this.called, this.functions] = outer;
      return answer;
    } catch (error) {
      this.begin();
      throw error;
    }
  }

  // The same, read by `read(Reader)`, to the last byte.
  ask(name, writer, read, functions = []) {
    const reader = new Reader(this.bytes(name, writer, functions));
    let value;
    try {
      value = read(reader);
      if (reader.at !== reader.view.byteLength) throw new Error('bytes are left over after the answer');
    } catch (error) {
      throw error instanceof Ended ? error : new Ended('wrong', name, error.message);
    }
    return value;
  }
}
