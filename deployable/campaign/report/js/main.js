// The page put together: player, keys, theme, print.

const root = document.documentElement;
const darkAsked = matchMedia("(prefers-color-scheme: dark)");

// Without WebGL the still picture remains.
let viewer = null, stills = null;
if (MOTION && make("canvas").getContext("webgl2")) {
  byId("motion").classList.add("moves");
  viewer = new Viewer(byId("view"), await Promise.all(MOTION.runs.map((bytes) => Played.read(bytes.slice().buffer))));
  viewerControls(viewer);
  stills = new Stills(viewer);
}

function repaint() {
  if (!viewer) return;
  viewer.recolour();
  stills.draw();
}

// Draw all that depends on which runs are shown; the stills too, unless a slider is moved.
function showRuns(all = true) {
  if (all) repaint();
  else if (viewer) { viewer.recolour(); viewer.draw(); }
  drawMarks();
  for (const chart of charts) chart.draw();
}

function theme(name) {
  root.dataset.theme = name;
  repaint();
}

function drawPlayer() {
  const slider = byId("time"), play = byId("play"), duration = LAST - FIRST;
  Object.assign(slider, { min: FIRST, max: LAST });
  slider.addEventListener("input", () => { clock.play(false); clock.set(Number(slider.value)); });
  play.addEventListener("click", () => clock.play());
  clock.listen((time) => {
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${digits(time, 4)} seconds`);
    byId("now").textContent = `${time.toFixed(duration < 10 ? 3 : 2)} s`;
    if (play.textContent !== (clock.playing ? "❚❚" : "▶")) {
      play.textContent = clock.playing ? "❚❚" : "▶";
      play.setAttribute("aria-label", clock.playing ? "Pause" : "Play");
    }
  });
  const speeds = [2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].filter((s) => duration / s >= 0.5 && duration / s <= 200);
  const usual = speeds.reduce((best, s) => (Math.abs(Math.log(duration / s / 10)) < Math.abs(Math.log(duration / best / 10)) ? s : best));
  for (const s of speeds) byId("speed").append(make("option", { value: s }, s >= 1 ? `× ${s}` : `1/${Math.round(1 / s)}`));
  byId("speed").value = clock.speed = usual;
  byId("speed").addEventListener("change", ({ target }) => { clock.speed = Number(target.value); });
}

// Marks of closures above the slider, in the colours of the runs that are shown.
function drawMarks() {
  byId("marks").replaceChildren();
  DATA.moving.forEach(({ run }, i) => {
    if (!SHOWN.has(i)) return;
    for (const { time } of closures(DATA.runs[run])) {
      const left = (100 * (time - FIRST)) / (LAST - FIRST);
      byId("marks").append(make("i", { style: `left:${left}%;background:var(${SHOWN.colour(i)})` }));
    }
  });
}

// Closures of the nominal run.
function drawEvents() {
  const first = DATA.runs[DATA.moving.length ? DATA.moving[0].run : 0];
  const moments = closures(first);
  if (!moments.length) return;
  byId("events").append("Contacts, stops and latches that close in the nominal run: ");
  for (const { time, names } of moments.slice(0, 12)) {
    const button = make("button", { type: "button" }, `${names} at ${digits(time, 4)} s`);
    button.addEventListener("click", () => { clock.play(false); clock.set(time); });
    byId("events").append(button);
  }
  if (moments.length > 12) byId("events").append(` and ${moments.length - 12} later moments`);
}

function stepFrames(count) {
  const frames = viewer ? viewer.runs[0].frames.map((time) => FIRST + time) : TIME;
  clock.play(false);
  clock.set(frames[Math.min(frames.length - 1, Math.max(0, nearest(frames, clock.time) + count))]);
}

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (/^(SELECT|BUTTON|SUMMARY|A)$/.test(event.target.tagName) || event.target.type === "checkbox" || event.target.closest("#what-if")) return;
  const far = event.shiftKey ? 10 : 1;
  const actions = {
    " ": () => clock.play(), ArrowLeft: () => stepFrames(-far), ArrowRight: () => stepFrames(far),
    Home: () => clock.set(FIRST), End: () => clock.set(LAST),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
});

for (const button of document.querySelectorAll(".jump")) {
  button.addEventListener("click", () => {
    clock.play(false);
    clock.set(Number(button.dataset.time));
    byId("motion").scrollIntoView();
  });
}
byId("theme").addEventListener("click", () => theme(root.dataset.theme === "dark" ? "light" : "dark"));
darkAsked.addEventListener("change", ({ matches }) => theme(matches ? "dark" : "light"));

// Paper is white, and finer than a screen.
const PAPER = 690, PICTURE = 234; // pixels: between the margins of A4, and high (as the style has it)
let before = null;
addEventListener("beforeprint", () => {
  before = root.dataset.theme;
  root.dataset.theme = "light";
  repaint();
  viewer?.drawNow(3, PAPER, PICTURE);
  viewer?.copyTo(byId("paper"));
  for (const chart of charts) { chart.onPaper = true; chart.draw(PAPER); }
});
addEventListener("afterprint", () => {
  root.dataset.theme = before;
  repaint();
  for (const chart of charts) { chart.onPaper = false; chart.draw(); }
});

drawPlayer();
drawMarks();
drawEvents();
const charts = drawCharts();
const whatIf = byId("what-if") && new WhatIf(DATA.whatIf);
clock.set(DATA.responses[0].widest);
