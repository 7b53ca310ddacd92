// The parts of the live page's script, put together as the program does it, are one script: no name
// of the player's parts is taken twice. And the chart of virtual times says where its moves end.
// Usage: node script_test.mjs ROOT
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { Script } from 'node:vm';

const root = process.argv[2], server = readFileSync(join(root, 'framework/live/session_pages.cpp'), 'utf8');
const lists = [...server.matchAll(/for \(const char\* part\s*:\s*\{([^}]*)\}/g)].map(found => [...found[1].matchAll(/"([\w.]+)"/g)].map(name => name[1]));
if (lists.length !== 2 || lists.some(list => list.length === 0)) throw new Error('session_pages.cpp lists the parts of the script in another way');
const folders = ['framework/report/player', 'framework/live/page'];
const parts = lists.flatMap((list, i) => list.map(name => readFileSync(join(root, folders[i], name), 'utf8')));
new Script(`'use strict';\n(() => {\n${parts.join('\n')}\n})();\n`, { filename: 'live.js' });   // compiled, not run

const curves = readFileSync(join(root, 'framework/live/page/live_curves.js'), 'utf8');
const chart = new Script(`${curves}\nnew TimesChart();`).runInNewContext({ html: () => ({ setAttribute() {} }), short: String });
chart.add({ processes: ['a', 'b'], from: 0, moves: [[0, 0, 0.5, 0], [1, 0, 0.25, 0.25], [0, 0.5, 0.3, 0.25]] });
if (chart.told() !== '3 moves of the scheduler, 1 rollback; global virtual time 0.25 s') throw new Error(chart.told());
chart.add({ processes: ['a', 'b'], from: 3, moves: [], is_cut: true });   // told behind the last move
if (!/^The first 3 moves .*Later moves are not recorded, because/.test(chart.told())) throw new Error(chart.told());
chart.add({ processes: ['a', 'b'], from: 0, moves: [] });   // another run
if (chart.told().includes('Later moves')) throw new Error(chart.told());

// Far from the world's origin places come from the page's; what is read is in the world.
const part = name => readFileSync(join(root, name), 'utf8');
const script = ['framework/report/player/model.js', 'framework/report/player/plot.js', 'framework/live/page/live_run.js'].map(part).join('\n');
const runAt = origin => new Script(`${script}\nnew LiveRun({ scene: { origin: [${origin}], bodies: [{ immovable: false }] } }, 'now');`).runInNewContext({});
const read = origin => {
  const run = runAt(origin);
  run.addFrame([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, /* body */ 0.25, -0.5, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, /* drift */ 0]);
  const [x] = run.bodySeries(0);
  return [run.placeInWords(run.moving.get(0).slice(0, 3).map(c => c[0]), 5).join(' '), x.values[0], x.offset].join(' | ');
};
for (const [origin, expected] of [[[0, 0, 0], '0.25 -0.5 1 | 0.25 | '], [[1e6, -2e6, 0], '1000000.25 -2000000.5 1 | 0.25 | 1000000']])
  if (read(origin) !== expected) throw new Error(`${read(origin)} instead of ${expected}`);
