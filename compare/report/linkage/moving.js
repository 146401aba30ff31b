// One position of the drive for all: the picture moves to it, and every plot over the drive has its cursor there.
const root = document.getElementById("linkage"), find = selector => root.querySelector(selector), svg = find("svg");

const parted = bytes => {
  const start = bytes.indexOf(10) + 1;
  const size = (bytes.length - start) / 4, words = new Uint8Array(4 * size);
  for (let byte = 0; byte < 4; byte++)
    for (let n = 0; n < size; n++) words[4 * n + byte] = bytes[start + byte * size + n];
  return [parsed(new TextDecoder().decode(bytes.subarray(0, start))), words.buffer];
};
for (const part of root.parentElement.children) {
  for (const { finished } of part.getAnimations()) await finished; // the verdict comes first
  part.style.animation = "none"; // and not again after printing
}
await painted(); // the page comes first
const [head, buffer] = parted(new Uint8Array(await inflated("motion").arrayBuffer()));
const { count, channels, panels, engines, axis, effort } = head;
await pause();

// --- numbers: the reference's are kept as second differences, an engine's as what they are off the reference's -------

const numbers = Float64Array.from(new Int32Array(buffer, 0, channels.length * count));
for (let c = 0; c < channels.length; c++) {
  const own = numbers.subarray(c * count, (c + 1) * count);
  for (let order = 0; order < 2; order++) for (let n = 1; n < count; n++) own[n] += own[n - 1];
  own.forEach((whole, n) => (own[n] = whole * head.quanta[c]));
}
const off = new Float32Array(buffer, 4 * channels.length * count);
const place = byName(channels.map((channel, c) => [channel, c * count]));
const width = head.compared + panels.length;
let isEdited = false; // the reference's numbers are those of another design, which no engine has solved
const ofEngine = (engine, row, n) => (isEdited ? NaN : off[((engine - 1) * width + row) * count + n]);
const difference = (channel, n, engine) => (engine ? ofEngine(engine, place[channel] / count, n) : 0);
const value = (channel, n, engine = 0, times = 1) => numbers[place[channel] + n] + times * difference(channel, n, engine);
const vector = ({ components: [x, y], on, way }, n, ...of) => // of a guide along its way, on what carries it
  y ? [value(x, n, ...of), value(y, n, ...of)] : turned(way, angle(on, n)).map(part => part * value(x, n, ...of));
const angle = (body, n) => (`${body}.angle` in place ? value(`${body}.angle`, n) : 0); // none of what does not turn
const error = (panel, n, engine) => ofEngine(engine, head.compared + panel, n);
const over = n => value(axis.channel, n) * axis.factor;
const rows = [...Array(count).keys()];
const nearest = at => rows.reduce((best, n) => (Math.abs(over(n) - at) < Math.abs(over(best) - at) ? n : best), 0);

const peak = values => values.reduce((most, v) => Math.max(most, Math.abs(v) || 0), 0);
const sized = (v, largest, zero, more) => (Math.abs(v) <= zero ? "0" : written(v, largest, more)); // zero: what is round-off
const position = n => withUnit(fixed(over(n), axis.decimals), axis.unit === "deg" ? "°" : axis.unit);

// --- the picture -----------------------------------------------------------------------------------------------------

const degrees = 180 / Math.PI;
const turned = ([x, y], by) => [x * Math.cos(by) - y * Math.sin(by), x * Math.sin(by) + y * Math.cos(by)];
const isBefore = engine => engine === head.before?.number;
const there = (point, n, engine = 0, times = 1) => { // m
  if (point in head.ground) return (isBefore(engine) && head.before.ground[point]) || head.ground[point];
  return vector({ components: [`${point}.x`, `${point}.y`] }, n, engine, times);
};
const inPicture = (x, y) => [(x - head.corner[0]) * head.perMetre, (head.corner[1] - y) * head.perMetre];
const at = (...of) => inPicture(...there(...of));
const polyline = points => { // nothing where one of them is nowhere
  const path = `M${points.map(point => point.map(z => z.toFixed(2)).join(" ")).join("L")}`;
  return /NaN|Inf/.test(path) ? "" : path;
};
const made = (name, parent, kind, attributes = {}) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, text] of Object.entries({ class: kind, ...attributes })) element.setAttribute(key, text);
  return parent.appendChild(element);
};

const movers = [...svg.querySelectorAll("[data-point]")];
const pose = n => {
  for (const mover of movers) {
    const { point, turn, to } = mover.dataset, [x, y] = at(point, n);
    let transform = `translate(${x} ${y})`;
    if (turn) transform += ` rotate(${-degrees * angle(turn, n)})`;
    if (to) {
      const [a, b] = at(to, n);
      transform += ` rotate(${degrees * Math.atan2(b - y, a - x)}) scale(${Math.hypot(a - x, b - y)} 1)`;
    }
    mover.setAttribute("transform", transform);
  }
};

const newtons = size => withUnit(written(size * head.newton[0]), head.newton[1]);
const forces = [...svg.querySelectorAll(".force:has(.head)")]; // not moments, whose arrows are of one size
const arrows = forces.map((group, k) => {
  const text = made("g", svg, "");
  made("title", text, "").textContent = `${head.arrows[k].load ? "" : "force of "}${head.arrows[k].name}`;
  return { ...head.arrows[k], group, text: made("text", text, `sign value${head.arrows[k].load ? " load" : ""}`) };
});

{% include "labels.js" %}

let crowded = 0; // forces that have no room for their values
const pull = (n, engine) => {
  const px = Number(svg.style.getPropertyValue("--px")), others = named(n, px);
  crowded = 0;
  const sized = arrows.map(arrow => ({ ...arrow, force: vector(arrow, n, +engine) })); // the largest first
  sized.forEach(arrow => (arrow.size = Math.hypot(...arrow.force)));
  for (const arrow of sized.sort((a, b) => b.size - a.size)) {
    const { size, force: [fx, fy] } = arrow;
    const length = size * head.perNewton * head.perMetre, shown = engine !== "" && length > 2 * px;
    arrow.group.style.display = arrow.text.style.display = "none";
    if (!shown) continue;
    const [u, v] = [fx / size, -fy / size], [, shaft, tip] = arrow.group.children, [cx, cy] = at(arrow.point, n);
    const aside = arrow.moment ? (head.larger * head.perMetre * (value(arrow.moment, n, +engine) || 0)) / size : 0;
    const [x, y] = [cx - aside * v, cy + aside * u]; // on the line that touches the friction circle
    const way = arrow.load ? -1 : 1, end = [x + way * length * u, y + way * length * v];
    arrow.text.textContent = newtons(size);
    const box = freePlace(end, [way * u, way * v], arrow.text.textContent.length * LETTER, others, px);
    crowded += box ? 0 : 1;
    if (!box) continue;
    others.push(box);
    arrow.group.style.display = arrow.text.style.display = "";
    arrow.group.setAttribute("transform", `translate(${x} ${y}) rotate(${degrees * Math.atan2(v, u)})`);
    shaft.setAttribute("transform", `scale(${length} 1)`);
    tip.setAttribute("transform", `translate(${arrow.load ? 0 : length} 0) scale(${Math.min(length / (11 * px), 1)})`);
    arrow.text.parentNode.setAttribute("transform", `translate(${box.x} ${box.y + 4 * px})`);
  }
};

const ofColour = (engine, ...where) => { // a path of an engine, or of an earlier run
  const path = made("path", ...where);
  path.style.stroke = head.colours[engine];
  if (isBefore(engine)) path.style.strokeDasharray = "6 4";
  return path;
};
const outlines = engines.slice(1).map((_, e) => ofColour(e + 1, svg.querySelector(".engines"), "engine"));
const magnified = (n, times) => outlines.forEach((path, e) => {
  const own = isBefore(e + 1) ? 1 : times; // an earlier run is always there, as it was
  const bodies = own ? Object.values(head.outlines) : [];
  path.setAttribute("d", bodies.map(points => polyline(points.map(point => at(point, n, e + 1, own)))).join(""));
});

const ring = made("circle", made("g", svg, "marked"), "sign mark", { r: 15 });
const mark = (n, point) => {
  ring.style.display = point ? "" : "none";
  if (point) ring.parentNode.setAttribute("transform", `translate(${at(point, n).join(" ")})`);
};

const drives = (n, engine) => value(effort.channel, n, engine) * effort.factor;
const drivesMost = effort && peak(rows.map(n => drives(n, 0)));
const joints = arrows.filter(arrow => !arrow.load);
const jointForces = (n, engine) => joints.map(joint => Math.hypot(...vector(joint, n, engine)) || 0);
const words = (n, engine) => {
  if (!joints.length) return "";
  const sizes = jointForces(n, engine), most = Math.max(...sizes);
  if (!most) return ""; // no solution here, or no forces
  const drive = effort ? ` Drive: ${withUnit(sized(drives(n, engine), drivesMost, effort.zero), effort.unit)}.` : "";
  const left = crowded ? ` No room for ${crowded} smaller ones.` : "";
  return `Largest joint force: ${newtons(most)}, ${joints[sizes.indexOf(most)].name}.${drive}${left}`;
};

const [force, magnify, sketch, slider, output] =
  ["[name=force]", "[name=magnify]", "[name=sketch]", "[type=range]", "output"].map(find);
const plots = new Map(); // by the section that has it
const followers = [], edits = [() => plots.forEach(plot => plot.edit())]; // drawn anew for a sample, for another design
let now = 0, marked = "";

const show = n => {
  now = n;
  pose(n);
  pull(n, force.value);
  magnified(n, +magnify.value);
  mark(n, marked);
  slider.value = n;
  slider.setAttribute("aria-valuetext", position(n));
  output.textContent = position(n);
  find(".now").textContent = words(n, +force.value);
  svg.setAttribute("aria-label", `${head.title} at ${axis.quantity} ${position(n)}. ${words(n, +force.value)}`);
  plots.forEach(plot => plot.show(n));
  followers.forEach(follow => follow(n));
};

await pause();

// --- one cursor through all plots ------------------------------------------------------------------------------------

const sum = ({ factors, magnitude }, of) => { // of a curve's channels, or the length of the vector that they are
  let whole = 0;
  for (const channel in factors) whole += (factors[channel] * of(channel)) ** (magnitude ? 2 : 1);
  return magnitude ? Math.sqrt(whole) : whole;
};
const plotted = (curve, n, engine) => sum(curve, channel => value(channel, n, engine));

const FINER_READ = 2; // digits more, by which engines are told from each other
class Plot {
  band = []; // low, high, and over what, of the machines; kept for whenever the plot is drawn

  constructor(section, panel) {
    this.plot = section.querySelector(".plot");
    Object.assign(this, { section, panel, curves: panels[panel]?.curves ?? [] });
    this.plot.addEventListener("drawn", () => (this.edit(), this.lay(), this.show(now)));
    seen.observe(section);
    plots.set(section, this);
    for (const kind of ["pointerdown", "pointermove"]) this.plot.addEventListener(kind, this);
  }

  table({ section, panel, curves }) {
    const table = element("table", { className: "readout" }), cells = [];
    const row = texts => {
      const own = texts.map((textContent, k) => element(k ? "td" : "th", { textContent }));
      table.insertRow().append(...own);
      return own;
    };
    row(["engine", ...curves.map(curve => `${curve.name} [${curve.unit}]`), "error"]);
    const most = curves.map(curve => peak(rows.map(n => plotted(curve, n))));
    engines.forEach((engine, e) => {
      const own = row([engine, ...curves.map(() => ""), ""]);
      own[0].style.setProperty("--c", head.colours[e]);
      curves.forEach((curve, k) => cells.push([own[k + 1], n => sized(plotted(curve, n, e), most[k], curve.zero, FINER_READ)]));
      if (e) cells.push([own.at(-1), n => (error(panel, n, e) >= 0 ? error(panel, n, e).toExponential(1) : "–")]);
    });
    section.querySelector("h3").after(table);
    return cells;
  }

  get drawn() { // where it is over the drive
    return this.plot.plot?.over === axis.title ? this.plot.plot : null;
  }

  edit() { // the curves of the design as it is now
    if (!this.drawn || !this.near || !this.curves.length) return;
    const curves = isEdited ? this.curves.map(curve => [curve.name, rows.map(n => plotted(curve, n))]) : [];
    this.drawn.edit(curves, rows.map(over));
  }

  lay(band = this.band) {
    this.band = band;
    this.drawn?.band(...band);
  }

  show(n) {
    if (this.near && this.panel >= 0) this.cells ??= this.table(this);
    if (this.near) this.cells?.forEach(([cell, text]) => (cell.textContent = text(n)));
    this.drawn?.show(over(n));
  }

  handleEvent({ type, target, clientX, pointerId }) {
    if (!this.drawn || this.drawn.zooms) return;
    const inside = target.closest(".u-over"); // buttons and legend have theirs
    if (type === "pointerdown" && inside) this.plot.setPointerCapture(pointerId);
    const held = this.plot.hasPointerCapture(pointerId);
    if (!held && !inside) return;
    const n = nearest(this.drawn.at(clientX));
    if (held) return scrub(n);
    stop();
    show(n);
  }
}
const seen = new IntersectionObserver(entries => {
  for (const { target, isIntersecting } of entries) {
    const plot = plots.get(target);
    plot.near = isIntersecting;
    plot.edit();
    plot.show(now);
  }
}, { rootMargin: "100%" });
for (const section of document.querySelectorAll("section:has(> h3):has(.plot)"))
  new Plot(section, panels.findIndex(panel => panel.title === section.querySelector("h3").textContent));

// --- what the reader does --------------------------------------------------------------------------------------------

const LONG = 5000, FRAME = 100; // ms: one run; what a frame advances at most, however late it comes
let playing = null, heard = 0;

const scrub = (n, mark = "") => {
  stop();
  marked = mark;
  show(Math.max(0, Math.min(count - 1, n)));
  clearTimeout(heard);
  heard = setTimeout(() => (find(".unseen").textContent = svg.getAttribute("aria-label")), 400);
};
const stop = () => {
  playing = null;
  find(".play").textContent = "Play";
};
const play = () => {
  const start = value("time", 0), span = value("time", count - 1) - start;
  find(".play").textContent = "Pause";
  marked = "";
  let share = now < count - 1 ? (value("time", now) - start) / span : 0, last = performance.now();
  const step = moment => {
    if (playing !== step) return;
    share += Math.min(Math.max(moment - last, 0), FRAME) / LONG;
    last = moment;
    show(rows.findLast(n => value("time", n) <= start + (share % 1) * span));
    requestAnimationFrame(step);
  };
  playing = step;
  requestAnimationFrame(step);
};

find(".play").onclick = () => (playing ? stop() : play());
slider.oninput = () => scrub(+slider.value);
force.onchange = magnify.onchange = () => show(now);
sketch.onchange = () => svg.querySelector(".ghost").setAttribute("visibility", sketch.checked ? "visible" : "hidden");
slider.onkeydown = event => { // the arrows, Home and End are its own
  if (event.key !== " ") return;
  find(".play").click();
  event.preventDefault();
};
document.addEventListener("click", event => {
  const goal = event.target.closest("[data-at]");
  if (!goal) return;
  const point = goal.dataset.point ?? "";
  scrub(nearest(goal.dataset.at * axis.factor), `${point}.x` in place || point in head.ground ? point : "");
  root.scrollIntoView({ block: "nearest" });
});
const fit = () => { // to the picture's size
  const px = String(1 / svg.getScreenCTM().a);
  if (svg.style.getPropertyValue("--px") === px) return;
  svg.style.setProperty("--px", px);
  show(now);
};
new ResizeObserver(() => plots.forEach(plot => plot.show(now))).observe(document.body);
for (const part of root.querySelectorAll(".player")) part.hidden = false;
await pause();
const most = rows.map(n => Math.max(0, ...jointForces(n)));
now = most.indexOf(Math.max(...most)); // at rest, where the largest joint force is
fit();
new ResizeObserver(fit).observe(svg);
