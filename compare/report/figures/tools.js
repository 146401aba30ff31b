// What a reader does with a figure: its legend and buttons, what is read off at the pointer, zoom by dragging, a picture.

const ICON = 18, ROW = 22, SHARP = 3; // px: of a legend; dots a px of a picture
const NEAR = 16, MOST = 8; // px around a point; values read out
const cut = part => chart => chart.see(Object.fromEntries(chart.panels.flatMap(({ names }) => [names.x, names.y]).map(axis => {
  const [lo, hi] = chart.range(axis);
  return [axis, [lo + part * (hi - lo), hi - part * (hi - lo)]];
})));
const drag = (chart, button) => {
  button.ariaPressed = chart.zooms = !chart.zooms;
  for (const { u } of chart.panels) u.cursor.drag.x = u.cursor.drag.y = chart.zooms;
};
const BUTTONS = [ // each in a square of 16
  ["Drag to zoom", "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4", drag],
  ["Zoom in", "M3 8h10M8 3v10", cut(0.25)], ["Zoom out", "M3 8h10", cut(-0.5)],
  ["Reset axes", "M3 8a5 5 0 1 0 2-4M5 1v3h3", chart => chart.see({})],
  ["Save as PNG", "M8 2v8M4.5 7 8 10.5 11.5 7M2 14h12", chart => save(chart)],
];

const icon = (pen, trace, x, y) => {
  const { line, marker, mode, low, box } = trace, one = { ...marker, size: 8, symbol: [marker.symbol].flat()[0] };
  Object.assign(pen, { strokeStyle: colour(trace), fillStyle: colour(trace), lineWidth: Math.min(line.width ?? 2, 5) });
  pen.globalAlpha = marker.opacity ?? 1;
  if (low || box) pen.fillRect(x, y - 5, ICON, 10);
  pen.globalAlpha = 1;
  if (low || box) return;
  pen.setLineDash(DASHES[line.dash] ?? []);
  if (mode !== "markers") pen.stroke(new Path2D(`M${x} ${y}h${ICON}`));
  pen.setLineDash([]);
  if (!mode.includes("markers")) return;
  const { stroke, fill } = symbols({ marker: one, X: [x + ICON / 2], top: [y] }, (...at) => at, 1);
  pen.lineWidth = marker.line?.width ?? 1;
  pen.stroke(stroke);
  pen.fill(fill);
};

const legend = chart => element("ul", { className: "key" }, ...chart.listed.map(trace => {
  const drawn = element("canvas", { width: ICON * SHARP, height: 14 * SHARP }), pen = drawn.getContext("2d");
  const group = trace.legendgroup, ariaPressed = !chart.hidden.has(group);
  const button = element("button", { type: "button", ariaPressed }, drawn, trace.name);
  pen.scale(SHARP, SHARP);
  icon(pen, trace, 0, 7);
  button.onclick = () => {
    const show = chart.hidden.delete(group);
    if (!show) chart.hidden.add(group);
    button.ariaPressed = show;
    for (const { u, traces } of chart.panels)
      traces.forEach(({ legendgroup }, k) => legendgroup === group && u.setSeries(k + 1, { show }));
    chart.refresh();
  };
  return element("li", {}, button);
}));

const bar = chart => BUTTONS.slice(chart.linked ? 0 : 1).map(([title, d, act]) => element("button", {
  type: "button", title, ariaLabel: title, ariaPressed: act === drag ? chart.zooms : null,
  onclick: ({ currentTarget }) => act(chart, currentTarget),
  innerHTML: `<svg viewBox="0 0 16 16" aria-hidden="true"><path d="${d}"/></svg>`,
}));

const menu = chart => (chart.layout.updatemenus?.[0].buttons ?? []).map(({ label, args: [{ x, y }] }, k) => {
  const onclick = ({ currentTarget }) => { // its numbers into the traces
    chart.chosen = k;
    for (const other of currentTarget.parentNode.children) other.ariaPressed = other === currentTarget;
    chart.traces.forEach((trace, n) => chart.replace(trace, y[n], x[n]));
    chart.refresh();
  };
  return element("button", { type: "button", textContent: label, ariaPressed: k === chart.chosen, onclick });
});

// --- what is read off at the pointer ---------------------------------------------------------------------------------

const nearest = (u, [left, top], trace) => { // of a curve across, of points and cells in both directions
  const x = u.posToVal(left, "x"), y = u.posToVal(top, "y"), markers = trace.mode === "markers";
  const wide = u.posToVal(left + 1, "x") - x, high = u.posToVal(top + 1, "y") - y; // of a pixel
  let best = null, least = NEAR * (markers ? 1 : 1.5);
  if (left < 0 || trace.hoverinfo === "skip") return best;
  for (let n = 0; n < trace.X.length; n++) {
    const across = (trace.X[n] - x) / wide, off = (trace.top[n] - y) / high, [from, to] = trace.box?.(n) ?? [];
    const inside = from <= x && x <= to && Math.abs(trace.Y[n] - y) < 0.5 ? 0 : NaN;
    const distance = trace.box ? inside : markers ? Math.hypot(across, off) : Math.abs(across) + 0 * off;
    if (distance < least) [best, least] = [n, distance];
  }
  return best;
};

const words = (trace, n) => {
  const { hovertemplate, name, type } = trace, number = type === "bar" ? trace.x[n] : trace.y[n];
  const swatch = element("i", { className: "swatch", style: `background: ${colour(trace)}` });
  if (!hovertemplate) return [element("span", {}, swatch, `${name}: ${short(number)}`)];
  const filled = hovertemplate.replace(/%\{(\w+)(?::\.(\d)(\w))?\}|<extra>.*/g, (_, of, digits, kind) => {
    if (!of) return "";
    const value = trace[of][n];
    return !kind ? value : kind === "e" ? value.toExponential(digits - 1) : tidy(value, +digits);
  });
  return filled.split("<br>").map(textContent => element("span", { textContent }));
};

const readOut = (chart, u, { traces, x }) => {
  const { left, top, idxs } = u.cursor, { text, layout, place, hidden } = chart;
  const shown = ([{ legendgroup }, n]) => n !== null && !hidden.has(legendgroup);
  const found = traces.map((trace, k) => [trace, idxs[k + 1]]).filter(shown);
  const off = ([trace, n]) => Math.abs(u.valToPos(trace.top[n], "y") - top);
  const [first, ...others] = found.sort((a, b) => off(a) - off(b));
  chart.near = left < 0 ? undefined : first?.[0].name;
  text.hidden = left < 0 || !first || layout.hovermode === false;
  if (text.hidden) return;
  const [title, unit = ""] = (x.title?.text ?? chart.over ?? "").split(/ ?\[|\]/);
  const [{ hovertemplate, x: across }, n] = first;
  const head = element("b", { textContent: `${title || "at"} ${short(across[n])} ${unit === "-" ? "" : unit}` });
  const listed = [first, ...others].slice(0, MOST).flatMap(one => words(...one));
  text.replaceChildren(...(hovertemplate ? words(...first) : [head, ...listed]));
  const box = place.getBoundingClientRect(), over = u.over.getBoundingClientRect();
  Object.assign(text.style, { top: `${over.top - box.top + top}px`, left: `${over.left - box.left + left}px` });
  text.classList.toggle("left", left > over.width / 2);
};

const zoom = (chart, { u, names }) => { // to what was dragged over, along one axis or both
  const { left, top, width, height } = u.select, { clientWidth, clientHeight } = u.over, view = { ...chart.view };
  const ends = (scale, ...places) => places.map(place => u.posToVal(place, scale)).sort((a, b) => a - b);
  if (width < clientWidth) view[names.x] = ends("x", left, left + width);
  if (height < clientHeight) view[names.y] = ends("y", top, top + height);
  u.setSelect({ width: 0, height: 0 }, false);
  chart.dragged = true;
  chart.see(view);
};

// --- a picture, for paper or a file ----------------------------------------------------------------------------------

const picture = async (chart, width, library) => {
  const rows = [...chart.columns(width)], us = rows.map(sized => chart.drawn(sized, SHARP, library));
  await null; // by then they are drawn
  const canvas = element("canvas", { className: "paper" }), pen = canvas.getContext("2d"), list = [];
  let x = 0, y = chart.listed.length ? ROW : 0, bottom = 0;
  for (const trace of chart.listed) {
    const wide = ICON + measured(trace.name) + 20;
    if (x && x + wide > width) [x, y] = [0, y + ROW];
    list.push([trace, x, y - ROW / 2]);
    x += wide;
  }
  const heads = rows.map(([{ note }, , column], k) => {
    if (!column && k) y = bottom;
    bottom = Math.max(column ? bottom : 0, y + ROW * !!note + us[k].height);
    return y;
  });
  Object.assign(canvas, { width: width * SHARP, height: (bottom + ROW * chart.notes.length) * SHARP });
  pen.scale(SHARP, SHARP);
  pen.fillStyle = shade("--page");
  pen.fillRect(0, 0, width, canvas.height);
  const write = (text, x, y, textAlign = "left") => {
    Object.assign(pen, { font: FONT, textAlign, textBaseline: "middle", fillStyle: shade("--ink") });
    pen.fillText(text, x, y);
  };
  for (const [trace, x, y] of list) {
    icon(pen, trace, x, y);
    write(trace.name, x + ICON + 4, y);
  }
  rows.forEach(([{ note }, wide, column], k) => {
    const left = column && rows[0][1] + GAP + (column - 1) * (wide + GAP), { ctx, width, height } = us[k];
    if (note) write(note.text, left + wide / 2, heads[k] + ROW / 2, "center");
    pen.drawImage(ctx.canvas, left, heads[k] + ROW * !!note, width, height);
    us[k].destroy();
  });
  chart.notes.forEach((note, k) => write(note, 0, bottom + ROW * (k + 0.5)));
  return canvas;
};

const onPaper = async work => { // in the light
  const { classList } = document.documentElement;
  classList.add("paper");
  shades.clear();
  const done = await work();
  classList.remove("paper");
  shades.clear();
  return done;
};
const save = async chart => {
  const canvas = await onPaper(() => picture(chart, chart.width, sharp()));
  const name = chart.place.ariaLabel.split(/[.,:] /)[0].replace(/\W+/g, "_");
  canvas.toBlob(blob => saved(blob, `${name}.png`));
};
