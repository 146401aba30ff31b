// The linkage solved in the page: the core's formulas as they were recorded, for numbers that the reader changes.
const bench = JSON.parse(await unpacked("design"));
const table = document.getElementById("bench"), inTable = selector => table.querySelector(selector);
const index = Object.fromEntries(bench.numbers.map(({ path }, k) => [path, k]));
const design = Float64Array.from(bench.numbers, ({ value }) => value), edited = design.slice();
const given = Object.fromEntries(Object.entries(bench.given).map(([name, values]) => [name, Float64Array.from(values)]));
const rate = index["drive.speed"];
const compiled = text => new Function(`return ${text}`)();
await pause();
const line = compiled(bench.line), strokes = Object.entries(bench.strokes).map(([name, s]) => [name, s, compiled(s.text)]);
const arrays = n => Array.from({ length: bench.channels.length + 1 }, () => new Float64Array(n)); // the last: the reach
const column = Object.fromEntries(bench.channels.map((channel, k) => [channel, k]));
const LIMIT = 1e-11, WAY = 720, HALVINGS = 60; // of a channel's peak; positions of a stroke; of a bracket

const largestAt = values => values.reduce((best, v, n) => (v > values[best] || Number.isNaN(values[best]) ? n : best), 0);

// --- the program -----------------------------------------------------------------------------------------------------

const strokeEnd = (number, { numbers: paths, given: names }, run) => { // of a slider, as `analytic` finds it
  const own = paths.map(path => number[index[path]]), of = { rate: 1, acceleration: 0 }, found = [[], [], []];
  const [least, most] = bench.extent;
  const at = position => {
    run(own, names.map(name => [name in of ? of[name] : position]), found, 1);
    return [found[2][0] * found[0][0], found[2][0] * found[1][0], found[2][0]]; // towards the closed end, its rate, sense
  };
  const way = Array.from({ length: WAY + 1 }, (_, n) => least + ((most - least) * n) / WAY);
  const closed = way.map(position => at(position)[0]);
  const last = largestAt(closed);
  let [low, high] = [way[Math.max(last - 1, 0)], way[Math.min(last + 1, WAY)]];
  const rising = at(low)[1] > 0;
  if (rising !== at(high)[1] > 0)
    for (let n = 0; n < HALVINGS; n++) at((low + high) / 2)[1] > 0 === rising ? (low = (low + high) / 2) : (high = (low + high) / 2);
  const dead = at((low + high) / 2)[0];
  return at(0)[2] * (dead > closed[last] ? dead : closed[last]); // the one that is a number
};

const unclosed = rows => [...rows.at(-1).keys()].filter(n => !(rows.at(-1)[n] >= 0)); // samples without a pose
const inputs = (number, of = values => values) => Object.entries(given).map(([name, values]) => {
  const faster = name === "time" && rate !== undefined ? number[rate] / design[rate] : 1; // where a speed is edited
  return faster === 1 ? of(values, name) : of(values, name).map(time => time / faster);
});
const givenAt = (names, number) => {
  const all = inputs(number);
  return names.map(name => all[Object.keys(given).indexOf(name)]);
};
const lengthOf = ([x, y, u, v], number) => (y === undefined ? number[x] : Math.hypot(number[u] - number[x], number[v] - number[y]));
const isFlat = (sides, number) => { // by Heron's formula, over the longest side
  const lengths = sides.map(side => lengthOf(side, number)), [a, b, c] = lengths.map(side => side / Math.max(...lengths));
  return Math.sqrt(Math.max((a + b + c) * (a + b - c) * (a - b + c) * (b + c - a), 0)) / 2 <= bench.height;
};
const unmet = number => bench.demands.find(({ terms, flat, sides }) => {
  if (sides) return isFlat(sides, number) !== flat;
  return !(terms.reduce((whole, [k, times]) => whole + times * number[k], 0) > 0);
});
const rewind = rows => { // the angles of torsion springs over whole turns, from the drive's start on
  for (const [name, bodies] of Object.entries(bench.wound)) {
    const [second, first] = bodies.map(channel => rows[column[channel]] ?? new Float64Array(count));
    let turned = 0;
    for (let n = 0; n < count; n++) {
      const rough = second[n] - first[n], whole = Math.round((turned - rough) / (2 * Math.PI));
      if (Number.isFinite(rough)) turned = rough + 2 * Math.PI * whole; // else there is no pose
      given[name][n] = turned;
    }
  }
};
const solve = (number, rows, by = line) => {
  for (const [name, stroke, run] of strokes) number[index[name]] = strokeEnd(number, stroke, run);
  by(number, inputs(number), rows, count);
  if (by === line && Object.keys(bench.wound).length) {
    rewind(rows);
    by(number, inputs(number), rows, count);
  }
  if (unmet(number)) rows.at(-1).fill(NaN);
  for (const n of unclosed(rows)) for (const row of rows) row[n] = NaN; // whatever the formulas give
  return rows;
};
let closing = null;
const gaps = (open, number) => { // at some samples, what does not close
  const { joints, text, numbers: paths, given: names } = bench.gaps, rows = joints.map(() => new Float64Array(count));
  (closing ??= compiled(text))(paths.map(path => number[index[path]]), givenAt(names, number), rows, count);
  return [...new Set(open.map(n => joints[rows.findIndex(row => !(row[n] >= 0))]))];
};
const rowsNow = arrays(count), rowsOfDesign = solve(design.slice(), arrays(count));
await pause();

const selfDifference = () => { // the largest, as a part of each channel's peak; NaN where there is one
  const parts = bench.channels.map((channel, c) => {
    const own = rowsOfDesign[c], peakOf = bench.peaks[c], q = head.quanta[head.channels.indexOf(channel)];
    const exact = bench.exact.rows.map((n, k) => Math.abs(own[n] - bench.exact.samples[c][k]));
    const packed = q === undefined ? [] : [...own].map((v, n) => Math.max(Math.abs(v - value(channel, n)) - q, 0));
    return Math.max(0, ...exact, ...packed) / peakOf;
  });
  return Math.max(0, ...parts);
};

// --- what a design is asked for --------------------------------------------------------------------------------------

const FINER = 16, LEVELS = 4; // positions of a bracket, and brackets in each other
const PEAKS = 3; // at most, that are looked at more closely
const few = arrays(FINER + 1);
const measures = { // of some channels, at n
  largest: (x, y) => n => (y ? Math.sqrt(x[n] * x[n] + y[n] * y[n]) : Math.abs(x[n])),
  least: (...all) => n => all.reduce((least, values) => Math.max(least, -values[n]), -Infinity),
  range: (x, y) => n => bench.along[0] * x[n] + bench.along[1] * y[n], // of the output, on its guide
};
const measured = ({ kind, channels }, rows) => measures[kind](...channels.map(channel => rows[column[channel]]));
const lawAt = time => { // what a motion law asks for, by its pieces: polynomials and sines
  const { pieces, cycle, gain } = bench.law, cycles = cycle ? Math.floor(time / cycle) : 0, own = time - cycles * cycle;
  const [begin, polynomial, sines, lag] = pieces.findLast(([begin]) => begin <= own) ?? pieces[0], t = own - begin - lag;
  let [position, rate, acceleration] = [0, 0, 0];
  for (const c of polynomial.toReversed())
    [position, rate, acceleration] = [position * t + c, rate * t + position, acceleration * t + 2 * rate];
  for (const [size, omega, phase] of sines) {
    position += size * Math.sin(omega * t + phase);
    rate += omega * size * Math.cos(omega * t + phase);
    acceleration -= omega ** 2 * size * Math.sin(omega * t + phase);
  }
  return { position: position + cycles * gain, rate, acceleration };
};
const between = places => (values, name) => places.map(p => { // of an input, between samples
  const n = Math.min(Math.floor(p), count - 2), share = p - n, along = at => at(n) * (1 - share) + at(n + 1) * share;
  const driven = bench.law && lawAt(along(n => value("time", n)));
  return driven && name in driven ? driven[name] : along(n => values[n]);
});
const refined = (number, of, best, levels) => { // the largest near a sample
  let [low, high, top] = [Math.max(best - 1, 0), Math.min(best + 1, count - 1), -Infinity];
  for (let level = 0; level < levels; level++) {
    const places = Array.from({ length: FINER + 1 }, (_, k) => low + ((high - low) * k) / FINER);
    line(number, inputs(number, between(places)), few, FINER + 1);
    if (unclosed(few).length) return top; // next to a place without a pose it may be as large as one likes
    const here = of(few), sizes = places.map((_, n) => here(n)), k = largestAt(sizes);
    top = Math.max(top, sizes[k]);
    [low, high] = [places[Math.max(k - 1, 0)], places[Math.min(k + 1, FINER)]];
  }
  return top;
};
const largest = (number, rows, of, levels) => { // SI, and the sample that is nearest
  const here = of(rows), sizes = rows[0].map((_, n) => here(n)), at = largestAt(sizes), most = sizes[at];
  const peaks = []; // both ends of a turn, where it is there
  for (let n = 0; n < sizes.length; n++) {
    const before = sizes[n] - sizes[n ? n - 1 : 1], after = sizes[n] - sizes[n + 1 < sizes.length ? n + 1 : n - 1];
    if (before >= 0 && after >= 0 && sizes[n] + (before + after) / 4 >= most) peaks.push(n); // an eighth is above, of a parabola
  }
  peaks.sort((a, b) => sizes[b] - sizes[a]);
  const found = peaks.slice(0, PEAKS).map(n => [refined(number, of, n, levels), n]);
  return found.reduce((best, one) => (one[0] > best[0] ? one : best), [most, at]);
};
const asked = (one, rows, number, levels = LEVELS) => {
  const of = rows => measured(one, rows), [top, at] = largest(number, rows, of, levels);
  if (one.kind === "least") return [-top, at];
  if (one.kind === "largest") return [one.channels.length > 1 ? top : top * Math.sign(rows[column[one.channels[0]]][at]), at];
  return [top + largest(number, rows, rows => n => -of(rows)(n), levels)[0], at];
};
