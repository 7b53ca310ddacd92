// What the tests say of each assignment.

const kVerdictClass = { right: 'right', wrong: 'wrong', crashed: 'wrong', 'out of time or memory': 'wrong', 'not attempted': 'todo', 'not run': 'todo' };

// Text with a link for every passage of a handout that it names.
function withHandoutLinks(text) {
  const parts = [];
  let end = 0;
  for (const found of (text || '').matchAll(/handouts\/(\w+)\.md(#[\w-]+)?/g)) {
    parts.push(text.slice(end, found.index), html('a', { href: `handouts/${found[1]}.html${found[2] || ''}`, target: '_blank', rel: 'noopener' }, found[0]));
    end = found.index + found[0].length;
  }
  return [...parts, (text || '').slice(end)];
}

// The line of a story that begins with a word: "likely: ..." or "read: ...".
function lineOf(story, word) {
  const found = new RegExp(`^\\s*${word}:\\s+(.*)$`, 'm').exec(story || '');
  return found ? found[1].trim() : '';
}

// Lines of a story. What stands behind a word and a colon, "found:    6 N s", goes on below itself.
function storyLines(story) {
  const lines = (story || '').replace(/^\n/, '').split('\n');
  return lines.map((line, i) => html('span', { className: /^ {2}[a-z ]+: +\S/.test(line) ? 'part' : '' }, line + (i + 1 < lines.length ? '\n' : '')));
}

class VerdictPane {
  // asked: what is shown above the verdicts
  constructor(asked) {
    this.asked = asked;
    this.box = html('div');
    this.by = 'cause';
    this.before = new Map();   // by assignment: verdicts of the check before, by test
    this.all = new Map();      // verdicts, by assignment
    this.now = '';             // id: of the tests that have run last
    this.note = null;          // {kind, id}: how they stand to the file that was saved last
    this.show();
  }

  saved(id) { this.note = { kind: 'saved', id }; this.show(); }

  busy(id) { this.note = { kind: 'busy', id }; this.show(); }

  // The file that was saved last does not compile.
  refused() {
    if (!this.note) return;
    this.note = { kind: 'refused', id: this.note.id };
    this.show();
  }

  set(verdicts) {
    this.note = null;
    this.now = verdicts.id;
    const last = this.all.get(verdicts.id);
    this.before.set(verdicts.id, new Map(last ? last.tests.map(test => [test.test, test.verdict]) : []));
    this.all.set(verdicts.id, verdicts);
    this.show();
  }

  noteInWords() {
    const { kind, id } = this.note, before = this.all.has(id) ? ' What stands below in grey is of the code before.' : '';
    if (kind === 'busy') return `The tests of ${id} run …${before}`;
    if (kind === 'saved') return `Saved: the tests of ${id} run when it has compiled.${before}`;
    return `The file of ${id} as it was saved last does not compile: no test of it ran.${before}`;
  }

  show() { keepFocus(this.box, () => this.build()); }

  build() {
    const open = new Set([...this.box.querySelectorAll('details[open]')].map(details => details.dataset.test));
    this.box.textContent = '';
    this.box.append(this.asked);
    if (this.note) this.box.append(html('p', { className: `note${this.note.kind === 'refused' ? ' bad' : ''}`, role: 'status' }, this.noteInWords()));
    if (this.all.size === 0 && !this.note) this.box.append(html('p', { className: 'soft' }, 'No test has run. They run when you save your file.'));
    const ids = [...this.all.keys()].sort((a, b) => (b === this.now) - (a === this.now) || (a < b ? -1 : 1));
    for (const id of ids) {
      const v = this.all.get(id), isOld = Boolean(this.note && this.note.id === id);
      if (id === this.now) {
        const shown = html('div', { className: isOld ? 'old' : '' });
        this.showOne(v, shown, open);
        this.box.append(shown);
        continue;
      }
      const folded = html('details', { className: isOld ? 'story old' : 'story' }, html('summary', {}, v.said ? `${v.title || id}: no test ran` : this.countInWords(v)));
      folded.dataset.test = `of ${id}`;
      folded.open = open.has(folded.dataset.test);
      this.showOne(v, folded, open);
      this.box.append(folded);
    }
  }

  pointsOf(tests) { return tests.reduce((sum, test) => sum + test.points, 0); }

  countInWords(v) {
    const right = v.tests.filter(test => test.verdict === 'right');
    return `${v.title}: ${right.length} of ${v.tests.length} tests are right, ${short(this.pointsOf(right))} of ${short(this.pointsOf(v.tests))} points of the public tests.`;
  }

  showOne(v, box, open) {
    if (v.said) { box.append(html('h2', { className: 'bad' }, `${v.file || v.id}: no test ran`), html('pre', {}, v.said)); return; }
    const right = v.tests.filter(test => test.verdict === 'right'), { mended, broken } = this.changeOf(v.id) || { mended: 0, broken: 0 };
    box.append(html('p', { className: 'count' }, this.countInWords(v)));
    if (mended + broken > 0) box.append(html('p', {}, html('span', { className: mended ? 'good' : '' }, `${mended} mended`), ', ', html('span', { className: broken ? 'bad' : '' }, `${broken} broken`), ' by this save.'));
    const choice = html('select', { ariaLabel: 'Grouping of the stories' }, html('option', { value: 'cause' }, 'by likely cause'), html('option', { value: 'group' }, 'by subject of the test'));
    choice.value = this.by;
    choice.addEventListener('change', () => { this.by = choice.value; this.show(); });
    const wrong = v.tests.filter(test => test.verdict !== 'right');
    if (wrong.length > 0) box.append(html('label', {}, 'Stories ', choice));
    for (const [name, tests] of this.groups(wrong)) {
      const points = short(this.pointsOf(tests));
      box.append(html('h2', { className: 'minor' }, `${name} (${tests.length} test${tests.length === 1 ? '' : 's'}, ${points} point${points === '1' ? '' : 's'})`));
      for (const test of tests) box.append(this.story(test, v, open));
    }
    if (wrong.length === 0) box.append(html('p', { className: 'good' }, 'Every public test is right. Hidden tests ask the same functions about other inputs.'));
    if (right.length > 0) {
      const list = html('details', { className: 'story right' }, html('summary', {}, `${right.length} right`), html('ul', { className: 'list' }, ...right.map(test => html('li', {}, test.title, this.tag(test, v) || ''))));
      list.dataset.test = `right of ${v.id}`;
      list.open = open.has(list.dataset.test);
      box.append(list);
    }
  }

  // In the order of mending, as `check` has it: what costs most first, in it first what names a slip; last what is not attempted.
  groups(tests) {
    const groups = new Map(), placeOf = test => (test.place === undefined ? Infinity : test.place);
    for (const test of [...tests].sort((a, b) => placeOf(a) - placeOf(b) || 0)) {
      const where = test.function ? `${test.function}${test.line ? ` (line ${test.line})` : ''}` : test.group;
      const cause = test.heading || (test.verdict === 'not attempted' ? `not attempted: ${test.function || test.group}` : lineOf(test.story, 'likely') || `${test.verdict} in ${where}`);
      const name = this.by === 'cause' ? cause : test.group;
      if (!groups.has(name)) groups.set(name, []);
      groups.get(name).push(test);
    }
    return [...groups];
  }

  // What the last save has changed in the verdicts of an assignment; null while they are not known.
  changeOf(id) {
    const v = this.all.get(id), before = this.before.get(id);
    if (!v || !before || before.size === 0 || v.said || (this.note && this.note.id === id)) return null;
    return {
      mended: v.tests.filter(test => before.has(test.test) && test.verdict === 'right' && before.get(test.test) !== 'right').length,
      broken: v.tests.filter(test => before.get(test.test) === 'right' && test.verdict !== 'right' && test.verdict !== 'not run').length,
    };
  }

  tag(test, v) {
    const was = (this.before.get(v.id) || new Map()).get(test.test);
    if (was === undefined) return null;
    if (was === test.verdict) return null;
    return test.verdict === 'right' ? html('span', { className: 'tag mended' }, 'mended') : html('span', { className: 'tag new' }, `was ${was}`);
  }

  story(test, v, open) {
    const where = test.line ? `${v.file}:${test.line} ${test.function}` : test.function || '', read = lineOf(test.story, 'read') || (/handouts\/[\w.]+#[\w-]+/.exec(test.story || '') || [''])[0];
    const details = html('details', { className: `story ${kVerdictClass[test.verdict] || ''}` }, html('summary', {}, `${test.verdict}: ${test.title}`));
    const tag = this.tag(test, v);
    if (tag) details.querySelector('summary').append(tag);
    details.dataset.test = `${v.id} ${test.test}`;
    details.open = open.has(details.dataset.test);
    if (where) details.append(html('p', { className: 'soft' }, where));
    details.append(html('pre', {}, ...storyLines(test.story)));
    if (test.printed) details.append(html('p', { className: 'soft' }, 'your code printed:'), html('pre', {}, test.printed));
    const link = this.handoutLink(read, v);
    if (link) details.append(html('p', {}, link));
    return details;
  }

  // "handouts/a1_impulse.md, eq. (A1.9)" becomes a link to that passage.
  handoutLink(read, v) {
    const file = /handouts\/(\w+)/.exec(read), page = file ? file[1] : v.handout.replace('handouts/', ''), equation = /\(A\d+\.\d+[a-z]?\)|A\d+\.\d+/.exec(read), anchor = /#([\w-]+)/.exec(read);
    const hash = anchor ? `#${anchor[1]}` : equation ? `#:~:text=${encodeURIComponent(equation[0].startsWith('(') ? equation[0] : `(${equation[0]})`)}` : '';
    return html('a', { href: `handouts/${page}.html${hash}`, target: '_blank', rel: 'noopener' }, hash ? `Read in the handout${equation ? `: equation ${equation[0]}` : ''}` : 'Open the handout');
  }
}
