const bytes = text => {
  const decoded = atob(text), all = new Uint8Array(decoded.length);
  for (let n = 0; n < all.length; n++) all[n] = decoded.charCodeAt(n);
  return all;
};
const inflated = id => {
  const zipped = new Blob([bytes(document.getElementById(id).textContent)]);
  return new Response(zipped.stream().pipeThrough(new DecompressionStream("gzip")));
};
const pause = () => new Promise(done => setTimeout(done)); // between two tasks, so that none is long
const painted = () => new Promise(done => requestAnimationFrame(() => setTimeout(done)));
const unpacked = id => inflated(id).text();

// Objects by name have nothing but their own: a point may be called `constructor`.
const byName = entries => Object.assign(Object.create(null), Object.fromEntries(entries));
const parsed = text => JSON.parse(text, (_, v) => (v && typeof v === "object" && !Array.isArray(v) ? byName(Object.entries(v)) : v));

const saved = (blob, download) => {
  const link = element("a", { href: URL.createObjectURL(blob), download });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

const closed = [];
addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details:not([open])")) closed.push(part) && (part.open = true);
});
addEventListener("afterprint", () => closed.splice(0).forEach(part => (part.open = false)));

addEventListener("pointerover", ({ target }) => {
  if (target.tagName === "DATA" && !target.title) target.title = target.value; // the number as it is
});

// Numbers as texts, rounded as in the tables: to four significant digits, five after a leading 1.
const grouped = text => text.replace(/^-?\d{5,}/, whole => whole.replace(/\B(?=(\d{3})+$)/g, "\u202f")).replace(/^-/, "−"); // from 10 000 on
const fixed = (v, decimals) => {
  const text = grouped(v.toFixed(decimals));
  return /[1-9]/.test(text) ? text : "0";
};
const DIGITS = 4, PLAIN = [1e-4, 1e9], ROUND_OFF = 1e-9; // significant; without a power of ten; of the largest, what is zero
const written = (v, largest = v, more = 0) => { // to as many decimals as the largest of its kind has, and some more
  const size = Math.abs(largest);
  if (!Number.isFinite(v)) return "–";
  if (Math.abs(v) <= ROUND_OFF * size) return "0";
  const [mantissa, exponent] = size.toExponential(DIGITS).split("e"), digits = DIGITS + (mantissa[0] === "1") + more;
  const isPlain = PLAIN[0] <= size && size < PLAIN[1];
  return isPlain ? fixed(v, Math.max(digits - 1 - exponent, 0)) : grouped(v.toExponential(digits - 1).replace("e+", "e"));
};
const withUnit = (text, unit) => text + (unit && unit !== "°" ? ` ${unit}` : unit);
const tidy = (v, digits = 3) => grouped(String(+v.toPrecision(digits)));
