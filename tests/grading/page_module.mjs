// Answers of a module of WebAssembly beside those of the same source on this machine's processor.
// Usage: node page_module.mjs ROOT MODULE.wasm CALLS
// CALLS: for each call its function's name, arguments and answer, each after its length (u32).
// Prints for each function: NAME CALLS BYTES-EQUAL WORST, the worst difference of a number, in parts
// of the largest number of its answer, or of 1 where that is smaller: arguments are of that size.
import { readFileSync } from 'node:fs';

const [root, wasm, calls] = process.argv.slice(2);
const { Law, Ended } = new Function(`${readFileSync(`${root}/framework/report/bench/host.js`, 'utf8')}\nreturn { Law, Ended };`)();
const law = new Law(readFileSync(wasm)), bytes = readFileSync(calls), seen = new Map();
let at = 0;
const next = () => { const length = bytes.readUInt32LE(at), piece = bytes.subarray(at + 4, at + 4 + length); at += 4 + length; return piece; };
while (at < bytes.length) {
  const name = String(next()), given = next(), native = next();
  const answer = Buffer.from(law.bytes(name, { length: given.length, bytes: () => given }));
  const one = seen.get(name) || { calls: 0, equal: 0, worst: 0 };
  seen.set(name, one);
  ++one.calls;
  if (answer.equals(native)) { ++one.equal; continue; }
  if (answer.length !== native.length) { one.worst = Infinity; continue; }
  // vectors of three: eight bytes of size, then the numbers; a lone number has no size
  const numbers = b => { const all = []; for (let i = 0; i < b.length;) { if (b.length > 8) i += 8; for (let k = 0; k < (b.length > 8 ? 3 : 1); ++k, i += 8) all.push(b.readDoubleLE(i)); } return all; };
  const a = numbers(answer), b = numbers(native), scale = Math.max(1, ...b.map(Math.abs));
  one.worst = Math.max(one.worst, ...a.map((x, i) => Math.abs(x - b[i]) / scale));
}
for (const [name, { calls: n, equal, worst }] of seen) console.log(name, n, equal, worst);
