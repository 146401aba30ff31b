// A force over the cycle as its tip draws it, in the frame of a body: what a pin or its bearing feels, by each engine.
const diagram = document.getElementById("polar"), RADIUS = 140, LARGEST = 0.2; // of the radius, a magnified difference
if (diagram) {
  const [chosen, frame] = ["vector", "frame"].map(name => diagram.querySelector(`[name=${name}]`));
  const [sheet, caption] = ["svg", ".caption"].map(selector => diagram.querySelector(selector));
  made("path", sheet, "grid").setAttribute("d", [0.5, 1].map(part => { // circles, and axes
    const r = RADIUS * part;
    return `M${-r} 0A${r} ${r} 0 0 0 ${r} 0A${r} ${r} 0 0 0 ${-r} 0M${-r} 0H${r}M0 ${-r}V${r}`;
  }).join(""));
  const curves = engines.map((_, e) => {
    const path = made("path", sheet, "curve");
    path.style.stroke = head.colours[e];
    return path;
  });
  const tip = made("path", sheet, "tip"), chosenOne = () => head.vectors[chosen.value];
  const turned = (n, of) => {
    const [x, y] = chosenOne().channels.map(of), turn = frame.value ? value(`${frame.value}.angle`, n) : 0;
    return [Math.cos(turn) * x + Math.sin(turn) * y, Math.cos(turn) * y - Math.sin(turn) * x];
  };
  const size = (n, of) => Math.hypot(...chosenOne().channels.map(of));
  const length = n => size(n, channel => value(channel, n));
  let scale = 0, whole = "";
  const point = ([x, y]) => `${(scale * x).toFixed(2)} ${(-scale * y).toFixed(2)}`;
  const follow = () => {
    const end = point(turned(now, channel => value(channel, now)));
    tip.setAttribute("d", /NaN/.test(end) ? "" : `M0 0L${end}`); // an edited linkage may have no pose here
    caption.textContent = `${whole} At ${position(now)}: ${tidy(chosenOne().factor * length(now), 4)} ${chosenOne().unit}.`;
    sheet.setAttribute("aria-label", caption.textContent);
  };
  const redraw = () => {
    const { factor, unit, name, bodies } = chosenOne(), sizes = rows.map(length), most = peak(sizes);
    const offs = engines.slice(1).flatMap((_, e) => rows.map(n => size(n, channel => difference(channel, n, e + 1))));
    const times = 10 ** Math.max(0, Math.floor(Math.log10((LARGEST * most) / peak(offs))));
    scale = most ? RADIUS / most : 0;
    curves.forEach((path, e) => {
      const of = n => channel => value(channel, n) + (e && Number.isFinite(times) ? times : 1) * difference(channel, n, e);
      const drawn = rows.map(n => point(turned(n, of(n)))).join("L");
      path.setAttribute("d", /NaN/.test(drawn) ? "" : `M${drawn}`);
    });
    const acts = bodies.length ? `Force of ${bodies[0]} on ${bodies[1]}` : name.replace(/^./, letter => letter.toUpperCase());
    const apart = peak(offs) > 0 ? ` Differences between the engines are ${times.toLocaleString("en")} times as large.` : "";
    whole = `${acts}. The outer circle is its peak, ${tidy(factor * most, 4)} ${unit} at ${position(sizes.indexOf(most))}.${apart}`;
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
    frames();
    redraw();
    diagram.scrollIntoView({ block: "nearest" });
  });
  frames();
}
