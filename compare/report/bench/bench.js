// What the reader changes: the picture, the curves and the peaks follow; nothing of it is cross-checked.
const groundOf = ground => byName(Object.entries(ground).map(([point, at]) => [point, [...at]]));
const run = { numbers: numbers.slice(), ground: groundOf(head.ground) }; // the reference's, as it was judged
const posed = bench.channels.filter(channel => channel in place && /\.(x|y|angle)$/.test(channel));
const grounded = bench.numbers.flatMap(({ path, value }, k) => {
  const [table, , point, q] = path.split(".");
  return table === "ground" ? [{ point, q, k, value }] : [];
});

const stand = solved => { // by sample, itself or the nearest one that has a pose
  const hasPose = n => solved.at(-1)[n] >= 0, poses = rows.filter(hasPose);
  const nearest = n => poses.reduce((best, m) => (Math.abs(m - n) < Math.abs(best - n) ? m : best), poses[0] ?? -1);
  return rows.map(n => (hasPose(n) ? n : nearest(n)));
};
const pushes = bench.loads.places.flatMap(load => [`${load} x`, `${load} y`]); // as the picture has them
const push = compiled(bench.loads.text);
const pushed = number => { // the loads of a design that is solved, component by component
  const { numbers: paths, given: names } = bench.loads, forces = pushes.map(() => new Float64Array(count));
  push(paths.map(path => number[index[path]]), givenAt(names, number), forces, count);
  return forces;
};
const fill = rows => {
  const from = stand(rows);
  bench.channels.forEach((channel, c) => channel in place && numbers.set(rows[c], place[channel]));
  for (const channel of posed)
    from.forEach((m, n) => (numbers[place[channel] + n] = m < 0 ? run.numbers[place[channel] + n] : rows[column[channel]][m]));
  for (const { point, q, k } of grounded) head.ground[point][q] = edited[k];
  pushed(edited).forEach((force, k) => numbers.set(force.map((v, n) => (rows.at(-1)[n] >= 0 ? v : NaN)), place[pushes[k]]));
};

// --- the picture -----------------------------------------------------------------------------------------------------

const shapes = Object.entries(head.outlines).map(([body, points]) => [body, points, find(`[data-turn="${body}"] > .own`)]);
const ways = [...svg.querySelectorAll(".path")], ghost = made("path", svg.querySelector(".engines"), "before");
const arm = ([ax, ay], [bx, by]) => [bx - ax, by - ay]; // from one point to another
const judged = (point, n) => inPicture(...run.ground[point] ?? ["x", "y"].map(q => run.numbers[place[`${point}.${q}`] + n]));
const reshape = n => { // bodies in their own frames, and as they were
  for (const [body, points, path] of shapes) {
    const own = point => turned(arm(at(points[0], n), at(point, n)), angle(body, n));
    path.setAttribute("d", polyline(points.map(own)));
  }
  ghost.setAttribute("d", isEdited ? shapes.map(([, points]) => polyline(points.map(point => judged(point, n)))).join("") : "");
};
followers.push(n => isEdited && reshape(n));

const guides = [...svg.querySelectorAll("[data-guides]")].map(guide => { // on the ground, along the way gone on them
  const { a, b } = guide.transform.baseVal.consolidate().matrix, point = guide.dataset.guides;
  const along = n => at(point, n).reduce((x, y) => a * x + b * y);
  const way = () => rows.map(along).reduce(([low, high], s) => [Math.min(low, s), Math.max(high, s)], [Infinity, -Infinity]);
  const [low, high] = way();
  return () => {
    const [first, last] = way(), [x, y] = at(point, now), back = first - along(now), longer = (last - first) / (high - low);
    guide.setAttribute("transform", `matrix(${a * longer} ${b * longer} ${-b} ${a} ${x + back * a} ${y + back * b})`);
  };
});

// --- numbers in, numbers out -----------------------------------------------------------------------------------------

const rowsIn = inTable(".numbers tbody").rows, rowsOut = inTable(".asked tbody").rows;
const judgedSizes = bench.asked.map((one, r) => {
  const [size] = asked(one, rowsOfDesign, design), was = Math.abs(size) > one.zero ? size : 0;
  const text = (...values) => {
    const shown = values.map(size => sized(one.factor * size, one.factor * (was || values[0]), one.factor * one.zero));
    return withUnit(shown.join(" to "), one.unit);
  };
  rowsOut[r].cells[1].textContent = text(was);
  return { was, text };
});
await pause();
const percent = (share, text) => {
  if (!Number.isFinite(share)) return "–";
  const size = text(Math.abs(share));
  return Number(size) ? `${share < 0 ? "−" : "+"}${size} %` : "0 %";
};
const compare = () => bench.asked.forEach((one, r) => {
  const isOpen = isEdited && unclosed(rowsNow).length; // a design that does not assemble everywhere has no peaks
  const [now, at] = isOpen ? [NaN, 0] : asked(one, isEdited ? rowsNow : rowsOfDesign, edited);
  const { was, text } = judgedSizes[r], [, , cell, change, where] = rowsOut[r].cells;
  cell.textContent = isOpen ? "–" : isEdited ? text(now) : "";
  change.textContent = isEdited ? percent(100 * (Math.abs(now / was) - 1), share => share.toFixed(1)) : "";
  where.textContent = Number.isFinite(now) ? position(at) : "–";
});

const update = () => {
  isEdited = edited.some((number, k) => number !== design[k] && bench.numbers[k].size);
  solve(edited, rowsNow);
  if (isEdited) fill(rowsNow);
  else numbers.set(run.numbers), Object.assign(head.ground, groundOf(run.ground));
  document.body.classList.toggle("edited", isEdited);
  if (isEdited) force.value = force.value && 0, magnify.value = 0;
  force.disabled = magnify.disabled = isEdited;
  const open = unclosed(rowsNow), wrong = unmet(edited);
  const from = () => `from ${position(open[0])} to ${position(open.at(-1))}, where it cannot close ${gaps(open, edited).join(" and ")}`;
  inTable(".open").textContent = wrong ? `No scene file may have these numbers: ${wrong.text}.` : open.length
    ? `The page finds no solution at ${open.length} of ${count} positions, ${from()}: the nearest pose is drawn.` : "";
  guides.forEach(lay => lay());
  ways.forEach((path, k) => path.setAttribute("d", polyline(rows.map(n => at(bench.paths[k], n)))));
  reshape(now);
  show(now);
  edits.forEach(redraw => redraw());
  list();
};
const list = () => {
  compare();
  for (const row of rowsIn) {
    const { k } = row.dataset, box = row.querySelector("input");
    if (box !== document.activeElement) box.value = +(edited[k] / bench.numbers[k].size).toPrecision(6);
    row.classList.toggle("changed", edited[k] !== design[k]);
  }
  clearTimeout(later);
  later = setTimeout(weigh, 250);
};
let later = 0, isNear = false; // whether the reader sees what a number weighs
new IntersectionObserver(([{ isIntersecting }]) => {
  isNear = isIntersecting;
  if (isNear) weigh();
}, { rootMargin: "50%" }).observe(inTable(".numbers"));

const STEP = 1e-4, FINE = 6; // of a number, to either side; so that places of jumps are known far better
let weighing = 0; // how often it has begun
const weigh = async () => { // by what share the chosen number of the design changes with 1 % of each of its numbers
  const mine = ++weighing, one = bench.asked[inTable("[name=weighed]").value], rows = arrays(count), number = edited.slice();
  const size = () => (unclosed(solve(number, rows)).length ? NaN : Math.abs(asked(one, rows, number, FINE)[0]));
  const now = size(), shares = [];
  for (const { dataset: { k } } of rowsIn) {
    const kept = number[k], [less, more] = [-1, 1].map(sign => {
      number[k] = kept * (1 + sign * STEP);
      return size();
    });
    number[k] = kept;
    shares.push(kept && now > one.zero ? (more - less) / (2 * STEP) / now : NaN); // of a zero there is no share
    await pause();
    if (mine !== weighing || !isNear) return;
  }
  const most = Math.max(...shares.map(share => Math.abs(share) || 0));
  [...rowsIn].forEach((row, r) => {
    const [bar, figure] = row.lastElementChild.children;
    bar.style.width = `${(4 * Math.abs(shares[r] / most) || 0).toFixed(2)}em`;
    figure.textContent = Math.abs(shares[r]) >= 5e-4 ? percent(shares[r], share => share.toPrecision(2)) : "";
  });
};

// --- dragging a pin changes the lengths and coordinates that lead to it, at the pose that is shown ----------------------

const metres = event => {
  const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return [x / head.perMetre + head.corner[0], head.corner[1] - y / head.perMetre];
};
const foot = (goal, [x, y], [u, v]) => { // of a point, on the line through another one
  const [dx, dy] = arm([x, y], goal), share = (dx * u + dy * v) / (u * u + v * v);
  return [x + share * u, y + share * v];
};
const dragged = (point, goal, n) => {
  const before = edited.slice();
  for (const move of bench.points[point]) {
    if (move.ground) {
      move.ground.forEach((k, q) => k >= 0 && (edited[k] = goal[q]));
      continue;
    }
    const from = there(point, n);
    if (move.slide) goal = foot(goal, from, turned(move.slide.along, angle(move.slide.on, n))); // on its guide
    else if (move.local.length) {
      const own = turned(arm(from, goal), -angle(move.body, n));
      own.forEach((d, q) => move.local[q] >= 0 && (edited[move.local[q]] += d));
    } else {
      const pivot = move.pivot && there(move.pivot, n);
      if (pivot) goal = foot(goal, pivot, arm(pivot, from)); // its drive leaves it only its length
      for (const [k, other] of move.lengths) edited[k] = Math.hypot(...arm(there(other, n), goal));
    }
  }
  if (!edited.every(Number.isFinite)) edited.set(before); // a foot on a line without a direction
  update();
};
for (const pin of svg.querySelectorAll("[data-point]:has(> .pin)")) {
  const { point } = pin.dataset;
  if (!bench.points[point].length) continue;
  pin.classList.add("draggable");
  pin.addEventListener("pointerdown", event => {
    stop();
    pin.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  pin.addEventListener("pointermove", event => pin.hasPointerCapture(event.pointerId) && dragged(point, metres(event), now));
}

// --- the file, and back ------------------------------------------------------------------------------------------------

const toml = () => {
  const tables = parsed(JSON.stringify(bench.tables));
  bench.numbers.forEach(({ path, size }, k) => {
    if (edited[k] === design[k] || !size) return;
    const parts = path.split("."), last = parts.pop(), turned = last.split("-").reverse().join("-");
    const table = parts.reduce((inner, part) => inner[part], tables);
    table[turned in table ? turned : last] = +(edited[k] / size).toPrecision(12);
  });
  const isTable = v => v && typeof v === "object" && !Array.isArray(v), isList = v => Array.isArray(v) && v.every(isTable) && v.length;
  const quoted = text => JSON.stringify(text).replaceAll("\x7f", "\\u007f"); // as TOML has it
  const number = v => (Number.isInteger(v) && !Number.isSafeInteger(v) ? v.toExponential() : String(v)); // it has 64 bits
  const key = name => (/^[\w-]+$/.test(name) ? name : quoted(name));
  const pairs = (v, gap) => Object.entries(v).map(([name, part]) => `${key(name)} = ${inline(part)}`).join(gap);
  const inline = v => Array.isArray(v) ? `[${v.map(inline).join(", ")}]` : isTable(v) ? `{ ${pairs(v, ", ")} }`
    : typeof v === "number" ? number(v) : typeof v === "string" ? quoted(v) : String(v);
  const lines = [];
  const section = (name, v) => lines.push(`\n[${name}]\n${pairs(v, "\n")}`);
  const plain = Object.entries(tables).filter(([, v]) => !(isTable(v) || isList(v)));
  lines.push(pairs(byName(plain), "\n"));
  for (const [name, v] of Object.entries(tables)) {
    if (isList(v)) v.forEach(one => section(`[${name}]`, one));
    else if (isTable(v) && Object.values(v).every(isTable)) Object.entries(v).forEach(([inner, one]) => section(`${key(name)}.${key(inner)}`, one));
    else if (isTable(v)) section(key(name), v);
  }
  return `${lines.join("\n")}\n`;
};

inTable(".numbers").addEventListener("input", ({ target }) => {
  const { k } = target.closest("tr").dataset, typed = target.valueAsNumber;
  if (!target.checkValidity() || !(typed || bench.numbers[k].zero)) return; // what no file may have
  edited[k] = Number.isFinite(typed) ? typed * bench.numbers[k].size : design[k];
  update();
});
inTable(".numbers").addEventListener("focusout", list); // what is no number of a file gives way to the one that is used
inTable("[name=weighed]").onchange = weigh;
document.querySelector(".undo").onclick = () => {
  edited.set(design);
  update();
};
document.querySelector(".copy").onclick = async () => {
  const box = document.querySelector("#scene-text");
  box.value = toml();
  box.closest("[hidden]")?.removeAttribute("hidden");
  box.select();
  await navigator.clipboard?.writeText(box.value).catch(() => {}); // else it is selected
};

const away = selfDifference(), check = document.getElementById("self-check");
const apart = `the numbers of the run${away ? ` to ${away.toExponential(0)} of each channel's peak` : ""}`;
check.dataset.difference = away;
inTable(".controls").hidden = !(away <= LIMIT);
check.textContent = away <= LIMIT ? `This page solves the linkage by itself, by the formulas of the reference. It has ${apart}.`
  : `This page does not find ${apart}: nothing can be changed here.`;
if (away <= LIMIT) {
  list();
  await painted();
  inTable("details").open = true; // of many numbers, laid out by themselves
}
