// A name stands at its pin, a value at its arrow's tip, or near it where that is taken; what has no place is not drawn.
const HIGH = 15, LETTER = 7.3, BOLD = 9; // px, of a line of text; wide, of a letter of a value, and of a name
const GAPS = [6, 18, 32, 48, 66, 90], TURNS = [0, 40, -40, 80, -80, 120, -120, 160, -160].map(turn => turn / degrees);
const clear = (a, b) => Math.abs(a.x - b.x) >= (a.wide + b.wide) / 2 || Math.abs(a.y - b.y) >= (a.high + b.high) / 2;
const inside = ({ x, y, wide, high }) => {
  const { width, height } = svg.viewBox.baseVal;
  return Math.abs(x - width / 2) <= (width - wide) / 2 && Math.abs(y - height / 2) <= (height - high) / 2;
};
const freePlace = ([x, y], [u, v], size, others, px) => {
  const wide = size * px, high = HIGH * px;
  const places = GAPS.flatMap(gap => TURNS.map(turn => {
    const [p, q] = turned([u, v], turn);
    return { x: x + p * (gap * px + Math.abs(p) * wide / 2), y: y + q * (gap * px + Math.abs(q) * high / 2), wide, high };
  }));
  return places.find(box => inside(box) && others.every(other => clear(box, other)));
};
const notes = [...svg.querySelectorAll(".scale")].map(({ textContent, y }) => [textContent.length * LETTER, y.baseVal[0].value]);
const pins = [...svg.querySelectorAll("[data-point]:has(> .name)")].map(group => {
  const name = group.querySelector(".name"), wide = (name.textContent.length + 0.4) * BOLD; // one capital may be wider
  const aside = { start: wide / 2, end: -wide / 2, middle: 0 }[name.getAttribute("text-anchor")];
  const own = { x: name.getAttribute("x"), y: name.getAttribute("y"), "text-anchor": name.getAttribute("text-anchor") };
  return { point: group.dataset.point, name, own, wide, middle: [Number(own.x) + aside, own.y - 5] };
});
const named = (n, px) => { // what is taken then: by notes, pins and names
  const places = pins.map(({ point }) => at(point, n)), bottom = svg.viewBox.baseVal.height;
  const taken = notes.map(([wide, y]) => ({ x: (8 + wide / 2) * px, y: bottom + (y - 5) * px, wide: wide * px, high: HIGH * px }));
  taken.push(...places.map(([x, y]) => ({ x, y, wide: 12 * px, high: 12 * px })));
  pins.forEach(({ name, own, wide, middle: [dx, dy] }, k) => {
    const [x, y] = places[k], far = Math.hypot(dx, dy), home = { x: x + dx * px, y: y + dy * px, wide: wide * px, high: HIGH * px };
    const free = inside(home) && taken.every(other => clear(home, other));
    const box = free ? home : freePlace(places[k], [dx / far, dy / far], wide, taken, px);
    name.style.display = box ? "" : "none";
    if (!box) return;
    taken.push(box);
    const moved = { x: (box.x - x) / px, y: (box.y - y) / px + 5, "text-anchor": "middle" };
    for (const [key, text] of Object.entries(free ? own : moved)) name.setAttribute(key, text);
  });
  return taken;
};
