// The parts of the live page's script, put together as the program does it, are one script: no name
// of the player's parts is taken twice. Usage: node script_test.mjs ROOT
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { Script } from 'node:vm';

const root = process.argv[2], server = readFileSync(join(root, 'framework/live/session_pages.cpp'), 'utf8');
const lists = [...server.matchAll(/for \(const char\* part\s*:\s*\{([^}]*)\}/g)].map(found => [...found[1].matchAll(/"([\w.]+)"/g)].map(name => name[1]));
if (lists.length !== 2 || lists.some(list => list.length === 0)) throw new Error('session_pages.cpp lists the parts of the script in another way');
const folders = ['framework/report/player', 'framework/live/page'];
const parts = lists.flatMap((list, i) => list.map(name => readFileSync(join(root, folders[i], name), 'utf8')));
new Script(`'use strict';\n(() => {\n${parts.join('\n')}\n})();\n`, { filename: 'live.js' });   // compiled, not run
