// What a panel of a figure is drawn with: its numbers as texts, the ticks of its axes, its colours, symbols and lines.

const ARRAYS = { f4: Float32Array, f8: Float64Array };
const DASHES = { dash: [8, 5], dot: [2, 3], dashdot: [8, 4, 2, 4], longdash: [14, 5], longdashdot: [14, 4, 2, 4] };
const FONT = "12px system-ui, sans-serif";
const SYMBOLS = { // within a circle of radius 1, or a little more
  circle: "M1 0A1 1 0 1 1-1 0 1 1 0 1 1 1 0z", square: "M-.9-.9H.9V.9H-.9z", diamond: "M0-1.3 1.3 0 0 1.3-1.3 0z",
  cross: "M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4z",
  x: "M-1.1-.5-.5-1.1 0-.6.5-1.1 1.1-.5.6 0 1.1.5.5 1.1 0 .6-.5 1.1-1.1.5-.6 0z",
  star: "M0-1.5.4-.5 1.4-.5.6.2.9 1.2 0 .6-.9 1.2-.6.2-1.4-.5-.4-.5z",
  "x-thin": "M-.9-.9.9.9M.9-.9-.9.9", "cross-thin": "M0-1.3V1.3M-1.3 0H1.3", "y-up": "M0-1.3V0L1.1.7M0 0-1.1.7",
  asterisk: "M-.9-.9.9.9M.9-.9-.9.9M0-1.2V1.2M-1.2 0H1.2",
};

const array = of => (of?.bdata ? new ARRAYS[of.dtype](bytes(of.bdata).buffer) : of ?? []);
const scaled = (values, log) => Float64Array.from(values, log ? v => (v > 0 ? Math.log10(v) : NaN) : v => v ?? NaN);
const extent = values => {
  let lo = Infinity, hi = -Infinity;
  for (const v of values) [lo, hi] = [v < lo ? v : lo, v > hi ? v : hi];
  return [lo, hi];
};
const ruler = document.createElement("canvas").getContext("2d");
const measured = text => ((ruler.font = FONT), ruler.measureText(text).width);

// --- numbers as texts ------------------------------------------------------------------------------------------------

const power = n => `10${String(n).replace(/./g, c => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻")}`;
const short = v => {
  if (!Number.isFinite(v)) return "–";
  return v && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6) ? grouped(v.toExponential(1).replace("e+", "e")) : written(v).replace(/(\..*?)0+$/, "$1").replace(/\.$/, "");
};

// Places on a scale, each with its text: multiples of 1, 2 or 5 times a power of ten, or some of `base`.
const even = (lo, hi, most, base) => {
  const least = (hi - lo) / Math.max(most, 1), ten = 10 ** Math.floor(Math.log10(least));
  let step = base * [1, 2, 3, 6, 12, 24, 48].find(times => times * base >= least);
  if (!(step <= hi - lo)) step = ten * [1, 2, 5, 10].find(times => times * ten >= 0.999 * least);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), from = Math.ceil(lo / step - 1e-9);
  const text = step < 1e-4 || Math.max(-lo, hi) >= 1e7 ? tidy : v => grouped((v || 0).toFixed(decimals));
  const count = Math.max(0, Math.floor(hi / step + 1e-9) - from + 1);
  return Array.from({ length: count }, (_, k) => (from + k) * step).map(v => [v, text(v)]);
};
const ticks = (lo, hi, most, { tickvals, ticktext, type, dtick }) => {
  const within = places => places.filter(([v]) => v >= lo && v <= hi);
  if (tickvals) return within(tickvals.map((v, k) => [v, ticktext[k]]));
  if (type !== "log") return even(lo, hi, most, dtick);
  const whole = even(lo, hi, Math.max(most, 3), dtick ?? 1).filter(([n]) => Number.isInteger(n)).map(([n]) => [n, power(n)]);
  const inScale = (v, text = tidy(v)) => [Math.log10(v), text];
  const tens = [0, 1, 2, 3].map(k => 10 ** (k + Math.floor(lo)));
  const between = within(tens.flatMap(ten => [inScale(ten), inScale(2 * ten), inScale(5 * ten)]));
  const few = between.length > 1 ? between : even(10 ** lo, 10 ** hi, most).map(one => inScale(...one));
  return whole.length > (dtick ? 1 : 2) || (whole.length > 1 && few.length > most) ? whole : few;
};

// --- colours, of the page as it is, light or dark --------------------------------------------------------------------

const shades = new Map();
const shade = name => {
  const own = name.startsWith("#") ? `--of-${name.slice(1)}` : name, style = getComputedStyle(document.documentElement);
  if (!shades.has(name)) shades.set(name, style.getPropertyValue(own).trim() || name);
  return shades.get(name);
};
const colour = ({ line, marker }) => shade(marker.color ?? line.color ?? "#555555");

// --- paths, by a function from numbers to px -------------------------------------------------------------------------

const outlines = Object.fromEntries(Object.entries(SYMBOLS).map(([name, d]) => [name, new Path2D(d)]));
const symbols = ({ marker: { symbol: of = "circle", size = 6, line: edge }, X, top }, place, ratio) => {
  const stroke = new Path2D(), fill = new Path2D(), radius = (size / 2) * ratio;
  for (let n = 0; n < X.length; n++) {
    const [x, y] = place(X[n], top[n]), name = Array.isArray(of) ? of[n] : of;
    if (Number.isNaN(x + y)) continue;
    const path = outlines[name.replace("-open", "")], there = { a: radius, d: radius, e: x, f: y };
    if (edge?.width) stroke.addPath(path, there);
    if (!/open|thin|y-up|asterisk/.test(name)) fill.addPath(path, there);
  }
  return { stroke, fill };
};
const line = ({ line: { shape }, low, X, top }, place) => {
  const stroke = new Path2D();
  for (let n = 0, before = NaN; n < X.length; n++) {
    const [x, y] = place(X[n], top[n]);
    if (shape === "hv") stroke.lineTo(x, before); // which does nothing where that is none
    if (Number.isNaN(before)) stroke.moveTo(x, y);
    else stroke.lineTo(x, y);
    before = Number.isNaN(x) ? NaN : y;
  }
  const fill = low && new Path2D(stroke);
  if (low) for (let n = X.length; n--; ) fill.lineTo(...place(X[n], low[n]));
  return { stroke, fill };
};
const placing = ({ valToPos }) => {
  const [x, wide] = [0, 1].map(v => valToPos(v, "x", true)), [y, high] = [0, 1].map(v => valToPos(v, "y", true));
  return (a, b) => [x + (wide - x) * a, y + (high - y) * b];
};
