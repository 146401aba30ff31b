// A force over the cycle as its tip draws it, in the frame of a body: what a pin or its bearing feels, by each engine.
const diagram = document.getElementById("polar"), RADIUS = 140, LARGEST = 0.2; // of the radius, a magnified difference
const [chosen, frame] = ["vector", "frame"].map(name => diagram.querySelector(`[name=${name}]`));
const [sheet, caption] = ["svg", ".caption"].map(selector => diagram.querySelector(selector));
made("path", sheet, "grid", { d: [0.5, 1].map(part => { // circles, and axes
  const r = RADIUS * part;
  return `M${-r} 0A${r} ${r} 0 0 0 ${r} 0A${r} ${r} 0 0 0 ${-r} 0M${-r} 0H${r}M0 ${-r}V${r}`;
}).join("") });
const curves = engines.map((_, e) => ofColour(e, sheet, "curve"));
const tip = made("path", sheet, "tip"), chosenOne = () => head.vectors[chosen.value];
const length = n => Math.hypot(...vector(chosenOne(), n));
let scale = 0, whole = "";
const end = (n, engine, times) => {
  const [x, y] = turned(vector(chosenOne(), n, engine, times), -angle(frame.value, n));
  return [scale * x, -scale * y];
};
const follow = () => {
  tip.setAttribute("d", polyline([[0, 0], end(now)])); // an edited linkage may have no pose here
  caption.textContent = `${whole} At ${position(now)}: ${written(chosenOne().factor * length(now), chosenOne().factor / scale * RADIUS)} ${chosenOne().unit}.`;
  sheet.setAttribute("aria-label", caption.textContent);
};
const redraw = () => {
  const { components, factor, unit, name, bodies } = chosenOne(), sizes = rows.map(length), most = peak(sizes);
  const off = (n, engine) => Math.hypot(...components.map(channel => difference(channel, n, engine)));
  const offs = engines.flatMap((_, e) => (isBefore(e) ? [] : rows.map(n => off(n, e))));
  const times = peak(offs) ? 10 ** Math.max(0, Math.floor(Math.log10((LARGEST * most) / peak(offs)))) : 1;
  scale = most ? RADIUS / most : 0;
  curves.forEach((path, e) => { // an earlier run is there as it was; how its bodies are turned is not in the page
    const known = isBefore(e) && frame.value ? [] : rows;
    path.setAttribute("d", known.length ? polyline(known.map(n => end(n, e, isBefore(e) ? 1 : times))) : "");
  });
  const acts = bodies.length ? `Force of ${bodies[0]} on ${bodies[1]}` : name.replace(/^./, letter => letter.toUpperCase());
  const apart = times > 1 ? ` Differences between the engines are ${grouped(String(times))} times as large.` : "";
  whole = `${acts}. The outer circle is its peak, ${written(factor * most)} ${unit} at ${position(sizes.indexOf(most))}.${apart}`;
  follow();
};
const frames = () => {
  const bodies = chosenOne().bodies.filter(body => `${body}.angle` in place);
  frame.replaceChildren(...["", ...bodies].map(body => new Option(body || "the ground", body)));
};
chosen.onchange = () => (frames(), redraw());
frame.onchange = redraw;
new IntersectionObserver((seen, observer) => { // first where it comes near
  if (!seen[0].isIntersecting) return;
  observer.disconnect();
  followers.push(follow);
  edits.push(redraw);
  redraw();
}, { rootMargin: "30%" }).observe(diagram);
let from = [0, 0];
svg.addEventListener("pointerdown", ({ clientX, clientY }) => (from = [clientX, clientY]));
svg.addEventListener("click", ({ target, clientX, clientY }) => { // on a pin, which is not dragged
  if (Math.hypot(clientX - from[0], clientY - from[1]) > 3) return;
  const pin = target.closest("[data-point]:has(> .pin)")?.dataset.point;
  const k = head.vectors.findIndex(({ at }) => at === pin);
  if (k < 0 || !pin) return;
  chosen.value = k;
  chosen.onchange();
  diagram.scrollIntoView({ block: "nearest" });
});
frames();
