// Figures are drawn near the viewport, all of them before a print; the library is unpacked after the first paint.
const inflated = id => {
  const zipped = Uint8Array.from(atob(document.getElementById(id).textContent), c => c.charCodeAt(0));
  return new Response(new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip")));
};
const unpacked = id => inflated(id).text();
const places = new Set(document.querySelectorAll("[data-figure]"));
const pointed = matchMedia("(hover: hover)").matches; // by a mouse: its bar of buttons would lie over a phone's legend
let figures, config;

const draw = place => {
  if (!figures || !places.delete(place)) return;
  const { data, layout } = figures[place.dataset.figure], { modeBarButtons } = config;
  const icon = Plotly.Icons.spikeline, click = () => Plotly.relayout(place, { dragmode: false });
  const own = layout.hovermode === false ? [[{ name: "Cursor", icon, click }]] : []; // back from zoom and pan
  const bar = { displayModeBar: pointed && "hover", modeBarButtons: [...modeBarButtons, ...own] };
  Plotly.newPlot(place, data, layout, { ...config, ...bar, responsive: true });
  for (const picture of place.querySelectorAll("svg")) picture.setAttribute("aria-hidden", "true"); // the label has it
  place.dispatchEvent(new Event("drawn"));
};

const near = new IntersectionObserver(
  seen => seen.filter(entry => entry.isIntersecting).forEach(entry => draw(entry.target)), { rootMargin: "600px" });

const unpack = async () => {
  const library = document.createElement("script");
  library.textContent = await unpacked("plotly");
  const drawn = JSON.parse(await unpacked("figures"));
  document.head.append(library);
  ({ figures, config } = drawn);
  for (const { layout } of figures) layout.template = drawn.template;
  places.forEach(place => near.observe(place));
};
if (places.size) requestAnimationFrame(() => setTimeout(unpack));

const closed = [];
addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details:not([open])")) closed.push(part) && (part.open = true);
  places.forEach(draw);
  for (const picture of document.querySelectorAll(".main-svg[height]")) { // drawn for the screen, scaled to the paper
    const size = [picture.getAttribute("width"), picture.getAttribute("height")];
    picture.setAttribute("viewBox", `0 0 ${size.join(" ")}`);
    picture.parentElement.style.aspectRatio = size.join("/");
  }
});
addEventListener("afterprint", () => closed.splice(0).forEach(part => (part.open = false)));

addEventListener("pointerover", ({ target }) => {
  if (target.tagName === "DATA" && !target.title) target.title = target.value; // the number as it is
});
