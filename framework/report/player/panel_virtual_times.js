// Local virtual times of an asynchronous engine: one bar per process up to its local virtual time,
// dark up to global virtual time (committed), with cuts where it was rolled back. The chart shows
// the scheduler's move that committed the cursor's time; the slider steps through the moves.

panelKinds.virtual_times = (box, data, player) => {
  const kRowHeight = 18, kLeft = 96, kTop = 26, moves = data.moves, names = data.processes, end = moves.reduce((latest, move) => Math.max(latest, move[2]), player.end);
  const slider = html('input', { type: 'range', min: '0', max: String(moves.length), step: '1', ariaLabel: 'Move of the scheduler' }), words = html('p', { className: 'move' });
  const canvas = html('canvas', { className: 'times' });
  slider.className = 'moves';
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', 'Local virtual times as bars');
  box.append(html('p', { className: 'legend times-legend' }, html('span', {}, html('i', { className: 'committed' }), ' committed'), html('span', {}, html('i', { className: 'ahead' }), ' ahead of global virtual time'),
    html('span', {}, html('i', { className: 'undone' }), ' undone by a rollback')), slider, words, canvas);

  // The state after k moves.
  const stateAfter = k => {
    const times = names.map(() => 0), undone = [];
    for (let i = 0; i < k; ++i) {
      const [process, from, to] = moves[i];
      times[process] = to;
      if (to <= from) undone.push({ process, from, to, age: k - i });
    }
    return { times, undone, gvt: k > 0 ? moves[k - 1][3] : 0 };
  };

  let shown = -1, cursor = 0;
  const draw = () => {
    const k = Number(slider.value), { times, undone, gvt } = stateAfter(k), ratio = window.devicePixelRatio || 1, width = canvas.clientWidth || 400, height = kTop + names.length * kRowHeight + 22;
    canvas.style.height = `${height}px`;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const g = canvas.getContext('2d'), x = t => kLeft + t / end * (width - kLeft - 12), bottom = kTop + names.length * kRowHeight;
    g.scale(ratio, ratio);
    g.font = '11px "DejaVu Sans", Arial, sans-serif';
    g.textAlign = 'center';
    for (const t of ticksOf(0, end, 6)) {
      g.fillStyle = '#d9e0e6';
      g.fillRect(x(t), kTop, 1, bottom - kTop);
      g.fillStyle = '#1c2733';
      g.fillText(short(t, 6), x(t), bottom + 13);
    }
    g.fillText('virtual time [s]', (kLeft + width) / 2, 12);
    names.forEach((name, i) => {
      const y = kTop + i * kRowHeight + 3, tall = kRowHeight - 6;
      g.textAlign = 'right';
      g.fillStyle = '#1c2733';
      g.fillText(name.length > 14 ? `${name.slice(0, 13)}…` : name, kLeft - 6, y + 9);
      g.fillStyle = '#3d8fc4';
      g.fillRect(x(0), y, x(times[i]) - x(0), tall);
      g.fillStyle = '#00446b';
      g.fillRect(x(0), y, x(Math.min(times[i], gvt)) - x(0), tall);
    });
    // A cut: the undone interval is hatched for some moves, and the time rolled back to stays
    // marked.
    for (const cut of undone) {
      const y = kTop + cut.process * kRowHeight + 1, tall = kRowHeight - 2;
      g.fillStyle = '#c14d00';
      g.fillRect(x(cut.to) - 1, y, 2, tall);
      g.globalAlpha = Math.max(0.15, 0.7 - 0.05 * cut.age);
      for (let at = x(cut.to); at < x(cut.from); at += 4) g.fillRect(at, y + 2, 1.5, tall - 4);
      g.globalAlpha = 1;
    }
    g.fillStyle = '#1c2733';
    g.fillRect(x(gvt) - 1, kTop - 4, 2, bottom - kTop + 4);
    g.textAlign = 'left';
    g.fillText('GVT', Math.min(x(gvt) + 4, width - 30), kTop - 3);
    g.fillStyle = '#a82c00';
    g.fillRect(x(cursor), kTop, 1.2, bottom - kTop);
    const last = k > 0 ? moves[k - 1] : null;
    words.textContent = `Move ${k} of ${data.is_cut ? 'the first ' : ''}${moves.length}: ` + (last ? `${names[last[0]]} ${last[2] <= last[1] ? 'rolled back' : 'on'} from ${short(last[1])} to ${short(last[2])} s; ` : '') +
      `global virtual time ${short(gvt)} s; ${undone.length} rollback${undone.length === 1 ? '' : 's'} so far` +
      (data.is_cut && k === moves.length ? '; later moves are not recorded' : '');
  };
  slider.addEventListener('input', draw);
  slider.addEventListener('keydown', event => event.stopPropagation());
  new ResizeObserver(draw).observe(canvas);
  return {
    // Goes to the first move after which t is committed.
    at(t) {
      cursor = t;
      let low = 0, high = moves.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if ((middle > 0 ? moves[middle - 1][3] : 0) >= t) high = middle; else low = middle + 1;
      }
      if (shown !== t) slider.value = String(low);
      shown = t;
      draw();
    },
  };
};
