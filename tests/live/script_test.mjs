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
