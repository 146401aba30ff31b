// The picture as a file: as it stands, or its motion as a film that the browser records.
const COLOURS = ["ink", "soft", "panel", "ok", "warn", "bad", "force", "path"]; // of the page, which a file has not
const WIDE = 900, STILLS = 125, EACH = 40; // px; pictures of a film, ms each
const asFile = () => {
  const copy = svg.cloneNode(true), { width, height } = svg.viewBox.baseVal;
  copy.setAttribute("width", WIDE);
  copy.setAttribute("height", (WIDE * height) / width);
  copy.style.setProperty("--px", width / WIDE);
  for (const name of COLOURS) copy.style.setProperty(`--${name}`, getComputedStyle(svg).getPropertyValue(`--${name}`));
  copy.prepend(made("rect", copy, "", { width, height, style: "fill: var(--panel); stroke: none" }));
  return new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" });
};
const film = async () => {
  const { width, height } = svg.viewBox.baseVal, canvas = document.createElement("canvas"), before = now;
  Object.assign(canvas, { width: WIDE, height: Math.round((WIDE * height) / width) });
  const pen = canvas.getContext("2d"), stream = canvas.captureStream(0), parts = [];
  const recorder = new MediaRecorder(stream, { mimeType: "video/webm" });
  recorder.ondataavailable = ({ data }) => parts.push(data);
  const finished = new Promise(done => (recorder.onstop = done));
  recorder.start();
  for (let k = 0; k < STILLS; k++) {
    show(Math.round((k / STILLS) * (count - 1)));
    const [due, picture, address] = [performance.now() + EACH, new Image(), URL.createObjectURL(asFile())];
    await new Promise((done, failed) => Object.assign(picture, { onload: done, onerror: failed, src: address }));
    URL.revokeObjectURL(address);
    pen.drawImage(picture, 0, 0, canvas.width, canvas.height);
    stream.getVideoTracks()[0].requestFrame();
    await new Promise(done => setTimeout(done, due - performance.now()));
  }
  recorder.stop();
  await finished;
  show(before);
  saved(new Blob(parts, { type: "video/webm" }), "linkage.webm");
};
find(".svg").onclick = () => saved(asFile(), "linkage.svg");
find(".film").onclick = async ({ currentTarget }) => {
  stop();
  currentTarget.disabled = true;
  await film().finally(() => (currentTarget.disabled = false));
};
find(".film").hidden = !globalThis.MediaRecorder;
