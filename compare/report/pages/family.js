
// The slider through a family's members: linkage, numbers, curves and row of the chosen one.
const slider = document.getElementById("member"), place = document.getElementById("chosen");
const members = [...slider.list.options], rows = [...document.querySelectorAll("#rows tbody tr")];
const plot = document.querySelector("[data-figure]"), moving = document.getElementById("moving");
const clocks = () => place.getAnimations({ subtree: true });
let panels, later;

const mark = () => {
  const { label, dataset } = members[slider.value];
  slider.ariaValueText = document.querySelector("#member + output").textContent = label;
  rows.forEach((row, k) => (row.ariaCurrent = k === +dataset.row ? "true" : null));
  clearTimeout(later);
  later = setTimeout(() => plot.plot?.emphasise(label), 50); // not at every step of a slider that is dragged
};

const show = async () => {
  mark();
  const wanted = slider.value, all = await (panels ??= unpacked("panels").then(JSON.parse));
  if (slider.value !== wanted) return;
  const time = clocks()[0]?.currentTime ?? 0, open = place.querySelector("details")?.open;
  place.innerHTML = all[wanted];
  clocks().forEach(clock => (clock.currentTime = time)); // the drive goes on from where it is
  place.querySelectorAll("details").forEach(part => (part.open = open));
};

const choose = number => {
  if (number < 0 || number === +slider.value) return;
  slider.value = number;
  show();
};

members.forEach((member, k) => {
  const row = rows[member.dataset.row];
  row?.classList.add("drawn");
  row?.addEventListener("click", () => choose(k));
});
plot.addEventListener("drawn", mark);
plot.addEventListener("chosen", ({ detail }) => choose(members.findIndex(member => member.label === detail)));
place.addEventListener("click", ({ target }) => {
  if (!target.matches(".go")) return;
  const { from, to } = place.querySelector("[data-from]").dataset;
  moving.checked = false;
  const share = (target.dataset.at - from) / (to - from);
  clocks().forEach(clock => (clock.currentTime = share * clock.effect.getTiming().duration));
});
slider.addEventListener("input", show);
document.querySelector(".player").hidden = false;
mark();
