// Machines within the scene's tolerances about the design as it is: a band in each plot, and how many meet the limits.
const drawn = bench.machines, chosen = inTable("[name=machines]"), PART = 8, FEW = 0.01; // ms of a frame; left out at each end
const limited = new Set(bench.limits.flatMap(({ channels }) => channels));
const idle = bench.channels.flatMap((name, k) => (bench.turning.includes(name) && !limited.has(name) ? [`row[${k}]`] : []));
let quick = null; // the program without angles that have no limit: their arcs take most of the time
const withoutAngles = () => compiled(bench.line.split("\n").filter(text => !idle.includes(text.split("[i]")[0])).join("\n"));
let isRunning = false, isStale = false; // whether the design has changed meanwhile

const TURN = 2 * Math.PI;
const moved = (values, { least, most }) => { // an angle goes on over whole turns, and is held where compare/judge/proof.py does
  for (let n = 1; n < values.length; n++) values[n] -= TURN * Math.round((values[n] - values[n - 1]) / TURN);
  const first = Math.min(...values), last = Math.max(...values), given = [least, most].filter(end => end !== null);
  const off = given.reduce((a, b) => a + b) / given.length - (first + last) / 2, turns = Math.round(off / TURN);
  const isPassed = given.length === 1 && Math.abs(off - TURN * turns) < (last - first) / 2;
  const isViolated = (least !== null && first < least) || (most !== null && last > most);
  const goesRound = given.length === 1 && last - first >= TURN;
  return goesRound || !(isPassed || isViolated) ? values : values.map(value => value + TURN * turns);
};
const meets = rows => bench.limits.every(limit => {
  const { kind, least, most, turns } = limit, of = measured(limit, rows), sign = kind === "least" ? -1 : 1;
  const values = Float64Array.from(rows[0], (_, n) => sign * of(n));
  return (turns ? moved(values, limit) : values).every(value => (least === null || value >= least) && (most === null || value <= most));
});
const empty = plot => { // a band around the first curve of a plot, which no machine has widened yet
  const ends = sign => new Float64Array(count).fill(sign * Infinity);
  return { plot, curve: plot.curves[0], low: ends(1), high: ends(-1) };
};
const widen = ({ curve, low, high }, rows) => { // by one machine more
  for (let n = 0; n < count; n++) {
    const v = sum(curve, channel => rows[column[channel]][n]);
    if (v < low[n]) low[n] = v;
    if (v > high[n]) high[n] = v;
  }
};
const machines = async () => {
  if (!chosen.checked) return;
  isStale = isRunning;
  if (isRunning) return;
  isRunning = true;
  const own = arrays(count), number = edited.slice(), every = drawn.off[0].length, sizes = bench.asked.map(() => []);
  const bands = [...plots.values()].filter(plot => plot.curves.length).map(empty);
  let running = 0, met = 0, unknown = 0, until = 0;
  for (let m = 0; m < every && !isStale; m++) {
    if (performance.now() >= until) {
      await new Promise(requestAnimationFrame);
      until = performance.now() + PART;
    }
    number.set(edited);
    drawn.numbers.forEach((k, j) => (number[k] += drawn.off[j][m]));
    const open = unclosed(solve(number, own, (quick ??= withoutAngles())));
    unknown += open.length && gaps(open, number).every(name => name === bench.gaps.balance);
    if (open.length) continue;
    running++;
    met += meets(own);
    bench.asked.forEach((wanted, k) => sizes[k].push(asked(wanted, own, number, 2)[0]));
    bands.forEach(band => widen(band, own));
  }
  isRunning = false;
  if (chosen.checked && !isStale) {
    judgedSizes.forEach(({ text }, k) => {
      const sorted = sizes[k].sort((a, b) => a - b), at = share => sorted[Math.round(share * (running - 1))];
      rowsOut[k].cells[5].textContent = running ? text(at(FEW), at(1 - FEW)) : "–";
    });
    const across = rows.map(over);
    for (const { plot, low, high } of bands) plot.lay([low, high, across]);
    // Some may run whose friction the page's few steps do not balance.
    const from = text => [...new Set([met, met + unknown].map(text))].join(" to "), stopped = every - running - unknown;
    const limits = bench.limits.length ? ` ${from(n => n)} of them, ${from(n => ((100 * n) / every).toFixed(1))} %, meet all limits of the scene at every sample.` : "";
    const none = stopped ? ` ${stopped} have no solution somewhere.` : "";
    const left = unknown ? ` For ${unknown} the page does not find ${bench.gaps.balance} somewhere.` : "";
    inTable(".machines").textContent = `${every} machines, as drawn by --monte-carlo ${every}.${none}${left}${limits} The plots show the band that they fill.`;
  }
  if (isStale) machines();
};
edits.push(machines);
chosen.onchange = () => {
  inTable(".machines").textContent = "";
  if (!chosen.checked) plots.forEach(plot => plot.lay([]));
  machines();
};
