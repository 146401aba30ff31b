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

// Numbers as texts.
const grouped = text => text.replace(/\d+/, whole => whole.replace(/\B(?=(\d{3})+$)/g, ",")).replace(/^-/, "−");
const tidy = (v, digits = 3) => grouped(String(+v.toPrecision(digits)));
