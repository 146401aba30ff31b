// Draws figures, which are data in plotly's names, by uPlot, one of it a panel: legend, buttons and read-out are the
// figure's. All scales are linear: of a logarithmic axis in its exponents. Other scripts have a figure as `place.plot`.

// px: a column without its texts, at least; between columns; the numbers along an axis; from where on a drag is along both axes.
const NARROW = 150, GAP = 14, TEXTS = 52, WIDE = 24;

class Chart {
  hidden = new Set(); // groups of the legend
  chosen = 0; // of the buttons with other numbers
  view = {}; // ranges that the reader has chosen, by axis

  constructor(place, { data, layout }) {
    const panels = new Map(), { annotations = [], dragmode, yaxis } = layout;
    for (const trace of data) {
      const name = trace.xaxis.slice(1), x = layout[`xaxis${name}`], y = layout[`yaxis${name}`];
      const note = annotations.find(n => n.y === y.domain[1] && x.domain[0] < n.x && n.x < x.domain[1]); // its title
      const names = { x: x.matches ?? `x${name}`, y: y.matches ?? `y${name}` }; // of the axes, which panels share
      const line = element("div", { className: "cursor" });
      if (!panels.has(name)) panels.set(name, { x, y, names, note, line, traces: [] });
      panels.get(name).traces.push(this.read({ line: {}, marker: {}, mode: "lines", ...trace }, x, y));
    }
    this.panels = [...panels.values()];
    this.traces = this.panels.flatMap(({ traces }) => traces);
    this.listed = this.traces.filter(({ showlegend }) => showlegend);
    this.notes = annotations.filter(note => !this.panels.some(panel => panel.note === note)).map(({ text }) => text);
    const over = this.panels.at(-1).x.title?.text; // what all panels are drawn over
    const linked = dragmode === false; // to the linkage, which a drag moves
    Object.assign(this, { place, layout, over, linked, zooms: !linked, title: yaxis.title?.text });
    this.stack();
  }

  read(trace, x, y) {
    for (const name of ["x", "y", "base"]) trace[name] = array(trace[name]);
    if (trace.type === "heatmap") trace.box = n => [trace.x[n] - 0.5, trace.x[n] + 0.5]; // its cells
    if (trace.type === "bar") trace.box = n => [trace.base[n], trace.base[n] + trace.x[n]];
    return Object.assign(trace, { X: scaled(trace.x, x.type === "log"), Y: scaled(trace.y, y.type === "log") });
  }

  stack() { // what is filled, and what is below it
    const below = {};
    for (const trace of this.traces) {
      trace.top = trace.Y;
      if (trace.fill) trace.low = trace.Y.map(() => 0);
      if (!trace.stackgroup || this.hidden.has(trace.legendgroup)) continue;
      trace.low = below[trace.stackgroup] ?? trace.Y.map(() => 0);
      below[trace.stackgroup] = trace.top = trace.Y.map((v, n) => v + trace.low[n]);
    }
  }

  range(name) { // chosen, given, or what is shown in all panels with that axis
    const letter = name[0], panels = this.panels.filter(({ names }) => names[letter] === name);
    const axis = panels[0][letter];
    if (this.view[name] ?? axis.range) return this.view[name] ?? axis.range;
    const shown = panels.flatMap(({ traces }) => traces).filter(({ legendgroup }) => !this.hidden.has(legendgroup));
    const ends = shown.flatMap(({ X, top, low = [] }) => (letter === "x" ? [X] : [top, low]).flatMap(extent));
    let [lo, hi] = extent(ends.filter(Number.isFinite));
    if (!(lo <= hi)) [lo, hi] = [0, 1];
    if (lo === hi) [lo, hi] = [lo - (Math.abs(lo) || 1) / 10, hi + (Math.abs(hi) || 1) / 10];
    const margin = letter === "x" && axis.type !== "log" && shown.some(({ mode }) => mode !== "markers") ? 0 : 0.05;
    return [lo - margin * (hi - lo), hi + margin * (hi - lo)];
  }

  // --- drawing ---

  *columns(width) { // yield each panel with its width and its column
    const most = new Set(this.panels.map(({ x }) => x.domain[0])).size;
    const shared = this.panels.some(({ y }) => y.matches); // the texts of the first column
    const columns = Math.max(1, Math.min(most, Math.floor(width / (NARROW + (shared ? 0 : TEXTS)))));
    const more = shared && columns > 1 ? TEXTS + 12 : 0;
    const each = Math.floor((width - more - GAP * (columns - 1)) / columns);
    for (const [k, panel] of this.panels.entries()) yield [panel, k % columns ? each : each + more, k % columns];
  }

  drawn([panel, width, column], ratio, library, place) {
    const { x, y, names, traces } = panel, { height, margin } = this.layout, marked = {};
    const backwards = this.layout[`xaxis${names.x.slice(1)}`].autorange === "reversed";
    const axis = (scale, of, size, label, space, quiet) => ({
      scale, size, label, labelSize: 18, gap: 4, font: FONT, labelFont: FONT, space: 1, stroke: () => shade("--ink"),
      grid: { show: of.showgrid !== false, width: 1, stroke: () => shade("--line") }, ticks: { show: false },
      incrs: (u, k, lo, hi) => [Math.max(10, hi - lo)], // any one: the splits are our own
      splits: (u, k, lo, hi, step, length) => {
        const most = u.bbox[scale === "x" ? "width" : "height"] / ratio / space;
        return (marked[scale] = ticks(lo, hi, most, of)).map(([v]) => v);
      },
      values: () => (quiet ? [] : marked[scale].map(([, text]) => text)),
    });
    const silent = y.showticklabels === false && !(column === 0 && y.matches), under = x.showticklabels !== false;
    const below = !under ? 12 : x.title ? 48 : 30, texts = Math.max(TEXTS, ...(y.ticktext ?? []).map(text => measured(text) + 8));
    const series = traces.map(trace => ({
      label: trace.name, show: !this.hidden.has(trace.legendgroup), alpha: trace.opacity ?? trace.marker.opacity ?? 1,
      width: trace.line.width ?? 2, dash: (DASHES[trace.line.dash] ?? []).map(d => d * ratio),
      stroke: () => colour(trace), fill: trace.low && (() => `${colour(trace)}66`),
      paths: u => this.path(u, trace, ratio),
      points: {
        show: trace.mode.includes("markers"), width: trace.marker.line?.width ?? 0, fill: () => colour(trace),
        paths: u => ({ ...symbols(trace, placing(u), ratio), flags: 3 }),
      },
    }));
    return new library({
      mode: 2, width, padding: [8, 16, 0, 0], legend: { show: false, live: false }, series: [null, ...series],
      height: Math.round((y.domain[1] - y.domain[0]) * (height - margin.t - margin.b)) + below,
      scales: {
        x: { auto: false, dir: backwards ? -1 : 1, range: () => this.range(names.x) },
        y: { auto: false, range: () => this.range(names.y) },
      },
      axes: [
        axis("x", x, under ? 22 : 4, x.title?.text, 70, !under),
        axis("y", y, silent ? 6 : texts, y.title?.text ?? (column ? undefined : this.title), 32, silent),
      ],
      cursor: {
        x: !this.linked, y: false, points: { size: 7 }, bind: { dblclick: () => () => this.see({}) },
        drag: { x: this.zooms, y: this.zooms, uni: WIDE, dist: 8, setScale: false },
        move: (u, ...at) => (panel.pointer = at), dataIdx: (u, k) => nearest(u, panel.pointer, traces[k - 1]),
      },
      hooks: {
        draw: [() => this.show(this.position)], setCursor: [u => readOut(this, u, panel)],
        setSelect: [() => zoom(this, panel)],
      },
    }, this.data(panel), place);
  }

  data = ({ traces }) => [null, ...traces.map(({ X, top }) => [X, top])];

  path(u, trace, ratio) {
    if (!trace.box) return trace.mode === "markers" ? null : { ...line(trace, placing(u)), flags: 0 };
    const { ctx, bbox: { left, top, width, height } } = u, place = placing(u), half = trace.meta ? 0.5 : 0.4;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    Object.assign(ctx, { font: FONT.replace("12", 11 * ratio), textAlign: "center", textBaseline: "middle" });
    ctx.globalAlpha = trace.marker.opacity ?? 1;
    trace.x.forEach((_, n) => {
      const [from, to] = trace.box(n), ground = trace.meta?.[n] ?? colour(trace), edge = trace.meta ? ratio : 0;
      const [x0, y0] = place(from, trace.Y[n] + half), [x1, y1] = place(to, trace.Y[n] - half);
      ctx.fillStyle = ground;
      ctx.fillRect(x0, y0, x1 - x0 - edge, y1 - y0 - edge);
      ctx.fillStyle = parseInt(ground.slice(3, 5), 16) > 120 ? "#000" : "#fff";
      if (trace.meta) ctx.fillText(trace.text[n], (x0 + x1) / 2, (y0 + y1) / 2);
    });
    ctx.restore();
    return null;
  }

  async build() { // aside: what is not yet in the page has no layout that a panel could ask for
    const { place } = this, host = element("div", { className: "panels" });
    const sized = [...this.columns((this.width = place.clientWidth))];
    const group = (name, ...buttons) => element("span", { className: name, role: "group" }, ...buttons);
    this.text = element("div", { className: "hover", hidden: true });
    const columns = 1 + Math.max(...sized.map(([, , column]) => column)), row = sized.slice(0, columns);
    host.style.gridTemplateColumns = row.map(([, width]) => `${width}px`).join(" ");
    host.onpointerdown = () => void (this.dragged = false);
    host.onclick = () => {
      if (this.near && !this.dragged) place.dispatchEvent(new CustomEvent("chosen", { detail: this.near }));
    };
    for (const [panel, ...size] of sized) {
      const own = element("div", {}, ...(panel.note?.text ? [element("p", { className: "title", textContent: panel.note.text })] : []));
      host.append(own);
      panel.u?.destroy();
      panel.u = this.drawn([panel, ...size], devicePixelRatio, uPlot(), own);
      panel.u.over.append(panel.line);
      await pause();
    }
    const tools = [legend(this), group("menu", ...menu(this)), group("buttons", ...bar(this))];
    const notes = this.notes.map(textContent => element("p", { className: "soft small", textContent }));
    const kept = place.querySelectorAll(".paper");
    place.replaceChildren(element("div", { className: "tools" }, ...tools), host, this.text, ...notes, ...kept);
    place.dispatchEvent(new Event("drawn"));
  }

  refresh() {
    this.soon = undefined;
    this.stack();
    for (const panel of this.panels) {
      const [min, max] = this.range(panel.names.x);
      panel.u?.setData(this.data(panel), false);
      panel.u?.setScale("x", { min, max }); // and the other one anew
    }
  }

  see(view) {
    this.view = view;
    this.refresh();
  }

  // --- what other scripts ask for ---

  show(at) { // the position of the drive, in all panels
    this.position = at;
    for (const { u, line } of this.panels) {
      const x = at === undefined ? -1 : u?.valToPos(at, "x");
      line.hidden = !(x > -0.5 && x < u?.bbox.width / devicePixelRatio + 0.5); // the element's own would be laid out anew
      line.style.transform = `translateX(${x}px)`;
    }
  }

  at(clientX) {
    const [{ u }] = this.panels;
    return u.posToVal(clientX - u.over.getBoundingClientRect().left, "x");
  }

  replace(trace, y, x = trace.x) {
    const panel = this.panels.find(({ traces }) => traces.includes(trace));
    this.read(Object.assign(trace, { x, y }), panel.x, panel.y);
  }

  edit(curves, x) { // of the first panel, by name; those judged are dotted meanwhile, and back where there are none
    const [panel] = this.panels, judged = panel.traces.filter(({ of }) => of);
    const lines = panel.traces.filter(({ mode, of, band }) => mode === "lines" && !of && !band);
    const faint = of => ({ ...of, of, name: `${of.name} as judged`, showlegend: false, opacity: 0.6, line: { ...of.line, dash: "dot" } });
    if (!curves.length && !judged.length) return;
    if (!judged.length) panel.traces.push(...lines.map(faint));
    for (const [name, y] of curves) this.replace(lines.find(trace => trace.name === name), y, x);
    if (!curves.length) judged.forEach(({ of, x, y }) => this.replace(of, y, x));
    if (!curves.length) panel.traces = panel.traces.filter(({ of }) => !of);
    if (!curves.length || !judged.length) this.build();
    this.soon ??= requestAnimationFrame(() => this.refresh());
  }

  band(low, high, x) { // of the first panel, from a curve to another one; without them none
    const [panel] = this.panels, had = panel.traces.find(({ band }) => band);
    const look = { band: true, name: "machines", mode: "lines", marker: {}, line: { width: 0, color: "#0072b2" }, opacity: 0.6 };
    if (x) Object.assign(had ?? look, { X: Float64Array.from(x), top: high, low });
    if (x && had) return this.refresh();
    panel.traces = x ? [...panel.traces, look] : panel.traces.filter(trace => trace !== had);
    if (x || had) this.build();
  }

  emphasise(name) {
    for (const { u, traces } of this.panels)
      traces.forEach((trace, k) => {
        [trace.opacity, trace.line.width] = trace.name === name ? [1, 4] : [0.45, 1.5];
        Object.assign(u.series[k + 1], { alpha: trace.opacity, width: trace.line.width });
      });
    this.refresh();
  }
}

// --- the figures of the page: unpacked when there is time, each drawn near the viewport by itself, all for a print ---

const places = [...document.querySelectorAll("[data-figure]")], once = make => {
  let made;
  return () => (made ??= make());
};
let library, packed, turn = Promise.resolve();
// The browser's own takes longest to start, and the texts are ours.
const Intl = { NumberFormat: class { format = String; }, DateTimeFormat: class { resolvedOptions = Object; } };
const compiled = (ratio = devicePixelRatio) =>
  Function("Intl", ratio === SHARP ? "devicePixelRatio" : "_", `${library}; return uPlot`)(Intl, ratio);
const sharp = once(() => compiled(SHARP)), uPlot = once(() => compiled()), figures = once(() => JSON.parse(packed));
const chart = place => (place.plot ??= new Chart(place, figures()[place.dataset.figure]));
const inTurn = job => (turn = turn.then(() => new Promise(done => setTimeout(() => done(job())))));
const draw = place => [figures, uPlot, () => chart(place), () => chart(place).build()].forEach(job => inTurn(job));
const resized = new ResizeObserver(all => all.forEach(({ target, contentRect: { width } }) => {
  if (width && target.plot?.width && Math.abs(width - target.plot.width) > 1) draw(target);
}));
const near = new IntersectionObserver(seen => seen.filter(entry => entry.isIntersecting).forEach(({ target }) => {
  near.unobserve(target);
  draw(target);
  resized.observe(target);
}), { rootMargin: "600px" });

requestIdleCallback(async () => {
  [library, packed] = [await unpacked("uplot"), await unpacked("figures")];
  places.forEach(place => near.observe(place));
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  shades.clear();
  places.filter(place => place.plot?.width).forEach(place => draw(place));
});
addEventListener("beforeprint", () => packed && onPaper(() => Promise.all(places.map(async place => {
  const drawn = await picture(chart(place), place.closest(".grid") ? 340 : 700, sharp()); // px of A4, as it is laid out
  place.querySelector(".paper")?.remove();
  place.append(drawn);
}))));
addEventListener("afterprint", () => document.querySelectorAll("canvas.paper").forEach(canvas => canvas.remove()));
