// The parts of the live page's script, put together as the program does it, are one script: no name
// of the player's parts is taken twice. And the chart of virtual times says where its moves end.
// Usage: node script_test.mjs ROOT
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { Script } from 'node:vm';

const root = process.argv[2], server = readFileSync(join(root, 'framework/live/served_files.cpp'), 'utf8');
const lists = [...server.matchAll(/for \(const char\* part\s*:\s*\{([^}]*)\}/g)].map(found => [...found[1].matchAll(/"([\w.]+)"/g)].map(name => name[1]));
if (lists.length !== 2 || lists.some(list => list.length === 0)) throw new Error('served_files.cpp lists the parts of the script in another way');
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

// What a run asks is sorted, and said where a save has changed nothing; a pull is one line.
const said = new Script(`${part('framework/live/page/live_scenes.js')}\n${part('framework/live/page/live_panes.js')}\n({ sortAsked, adviceOnSame, foldPushes });`).runInNewContext({ html: () => ({}) });
const module = { id: 'a1', laws: ['f', 'g'], functions: [['f', 12], ['g', 0], ['h', 0]] };
const sorted = JSON.stringify(said.sortAsked(module));
if (sorted !== '{"asked":[["f",12]],"elsewhere":["g"],"testsOnly":["h"]}') throw new Error(sorted);
if (!said.adviceOnSame([module], 'a1').startsWith('This scene asks a1 only for f: if you changed another function, look at the tests')) throw new Error(said.adviceOnSame([module], 'a1'));
if (!said.adviceOnSame([module], 'a2').startsWith('This scene asks nothing of a2')) throw new Error(said.adviceOnSame([module], 'a2'));
const force = (start_s, duration_s, size) => ({ body: 'box', force_n: [size, 0, 0], start_s, duration_s });
const folded = said.foldPushes([force(0, 0.1, 5), force(1, 1 / 60, 1), force(1 + 1 / 60, 1 / 60, 3), force(1 + 2 / 60, 1 / 60, 2), force(3, 1 / 60, 4)]).map(line => `${line.push.start_s} ${line.count} ${line.most_n}`).join('; ');
if (folded !== '0 1 5; 1 3 3; 3 1 4') throw new Error(folded);
