// The worker's end: runs an assignment's experiments on one module and answers with what moved.
// experiments (of the assignment's own script): {id, title, about, controls, takesPushes, run(recorder, values, pushes)}.

const longestRun = 5000;   // ms of one run, all calls together

// What a run leaves: frames of poses, each call with its answer, and named numbers.
class Recorder {
  constructor(law) { this.law = law; this.calls = []; this.frames = []; this.facts = []; this.bodies = []; this.t = 0; this.end = performance.now() + longestRun; }

  // A call of the module, noted with its answer as numbers.
  ask(name, write, read, functions) {
    if (performance.now() > this.end) throw new Ended('out of time', name, `the run took more than ${longestRun / 1000} s`);
    const writer = new Writer();
    write(writer);
    const value = this.law.ask(name, writer, read, functions);
    if (this.calls.length < 50000) this.calls.push({ name, t: this.t, answer: [value].flat(9).map(x => typeof x === 'object' && x !== null ? Object.values(x) : x).flat(9).map(Number) });
    return value;
  }
  // The same where every number of the answer has to be one.
  number(name, write, read, functions) {
    const value = this.ask(name, write, read, functions);
    if ([value].flat(9).some(x => !Number.isFinite(x))) throw new Ended('wrong', name, 'its answer is not a finite number');
    return value;
  }
  // @param lines  what else is drawn: {kind: 'rod', 'spring' or 'force', from, to}
  frame(bodies, lines = []) {
    if (this.bodies.length === 0) this.bodies = bodies.map(({ name, shape }) => ({ name, shape }));
    this.frames.push({ t: this.t, poses: bodies.flatMap(body => [...body.x, ...body.q]), lines });
  }
  // @param wanted  what it has to be, within `tolerance`; null: for information
  fact(name, value, unit, wanted = null, tolerance = 0) { this.facts.push({ name, value, unit, wanted, tolerance }); }
}

function runExperiment(law, { id, values, pushes }) {
  const experiment = experiments.find(one => one.id === id);
  const recorder = new Recorder(law);
  let stopped = null;
  try {
    law.begin();
    experiment.run(recorder, values, pushes);
  } catch (error) {
    if (!(error instanceof Ended)) throw error;
    stopped = { t: recorder.t, kind: error.kind, name: error.name_, words: error.message };
  }
  return { bodies: recorder.bodies, frames: recorder.frames, calls: recorder.calls, facts: recorder.facts, stopped };
}

if (typeof onmessage !== 'undefined' && typeof window === 'undefined' && typeof postMessage === 'function') {
  let law = null, last = '', said = 0;
  // The page has to know which function it waits for.
  const hears = name => {
    if (name === last && performance.now() - said < 100) return;
    last = name;
    said = performance.now();
    postMessage({ calling: name });
  };
  onmessage = ({ data }) => {
    try {
      if (data.wasm) {
        law = new Law(data.wasm, hears);
        postMessage({ ready: experiments.map(({ id, title, about, controls, takesPushes }) => ({ id, title, about, controls, takesPushes })) });
        return;
      }
      last = '';
      postMessage({ run: data.run, result: runExperiment(law, data) });
    } catch (error) {
      if (error instanceof Ended) postMessage({ trouble: `${error.name_}: ${error.message}` });
      else postMessage({ trouble: String(error.message || error) });
    }
  };
}
