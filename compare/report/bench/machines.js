// Machines within the scene's tolerances about the design as it is: a band in each plot, and how many meet the limits.
const drawn = bench.machines, chosen = inTable("[name=machines]"), PART = 8, FEW = 0.01; // ms of a frame; left out at each end
let quick = null; // the program without angles, whose arcs take most of the time
const every = drawn.numbers.length ? drawn.off[0].length : 0, own = arrays(count), number = new Float64Array(design.length);
let study = null; // of machines, while it goes on
let stale = false; // whether the design has changed meanwhile

const meets = rows => bench.limits.every(({ kind, channels, least, most }) => {
  const of = measured({ kind, channels: channels, along: [1, 0] }, rows);
  const values = kind === "largest" ? n => of(n) : channels.length > 1 ? n => -of(n) : n => rows[column[channels[0]]][n];
  return rows[0].every((_, n) => (least === null || values(n) >= least) && (most === null || values(n) <= most));
});
const begun = () => ({
  m: 0, lost: 0, met: 0, sizes: bench.asked.map(() => []),
  bands: [...plots.values()].filter(plot => plot.near && plot.drawn && plot.curves.length).map(plot => ({
    plot, curve: plot.curves[0], low: new Float64Array(count).fill(Infinity), high: new Float64Array(count).fill(-Infinity),
  })),
});
const one = () => {
  number.set(edited);
  drawn.numbers.forEach((k, j) => (number[k] += drawn.off[j][study.m]));
  solve(number, own, (quick ??= withoutAngles()));
  study.m++;
  if (stops(own) >= 0) return study.lost++;
  study.met += meets(own);
  bench.asked.forEach((wanted, k) => study.sizes[k].push(asked(wanted, own)[0]));
  for (const { curve: { factors, magnitude }, low, high } of study.bands) {
    const parts = Object.entries(factors).map(([channel, factor]) => [own[column[channel]], factor]);
    for (let n = 0; n < count; n++) {
      let whole = 0;
      for (const [values, factor] of parts) whole += magnitude ? (factor * values[n]) ** 2 : factor * values[n];
      const v = magnitude ? Math.sqrt(whole) : whole;
      if (v < low[n]) low[n] = v;
      if (v > high[n]) high[n] = v;
    }
  }
};
const ended = () => {
  const { lost, met, sizes, bands } = study, running = every - lost;
  bench.asked.forEach(({ factor, unit }, k) => {
    const sorted = sizes[k].sort((a, b) => a - b), at = share => factor * sorted[Math.round(share * (running - 1))];
    rowsOut[k].cells[5].textContent = running ? `${written(at(FEW), judgedSizes[k].places)} to ${written(at(1 - FEW), judgedSizes[k].places)} ${unit}` : "–";
  });
  for (const { plot, low, high } of bands) plot.drawn?.band(low, high, rows.map(over));
  const limits = bench.limits.length ? ` ${met} of them, ${((100 * met) / every).toFixed(1)} %, meet all limits of the scene at every sample.` : "";
  const none = lost ? ` ${lost} have no solution somewhere.` : "";
  inTable(".machines").textContent = `${every} machines, as drawn by --monte-carlo ${every}.${none}${limits} In the plots near by the band that they fill.`;
};
const step = () => {
  const until = performance.now() + PART;
  while (study.m < every && performance.now() < until) one();
  if (study.m < every) return requestAnimationFrame(step);
  if (chosen.checked) ended();
  study = null;
  if (stale) machines();
};
const machines = () => {
  if (!chosen?.checked) return;
  stale = study !== null;
  if (stale) return;
  study = begun();
  requestAnimationFrame(step);
};
edits.push(machines);
if (chosen) chosen.onchange = () => {
  table.classList.toggle("many", chosen.checked);
  inTable(".machines").textContent = "";
  if (!chosen.checked) plots.forEach(plot => plot.drawn?.band());
  machines();
};
