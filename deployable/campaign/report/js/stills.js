// Small pictures of telling moments; a click goes there.

const MOST_STILLS = 6;

// Moments in order of time: start, end, closures, and the largest differences of the bounds.
function moments() {
  const found = [{ time: FIRST, name: "start" }, { time: LAST, name: "end" }];
  for (const response of DATA.responses) found.push({ time: response.widest, name: `${response.name} widest` });
  const nominal = DATA.runs[DATA.moving[0].run];
  for (const { time, names } of closures(nominal)) {
    const [first, ...others] = names.split(", ");
    found.push({ time, name: others.length > 1 ? `${first} and ${others.length} more close` : `${names} close` });
  }
  const apart = 0.015 * (LAST - FIRST), kept = [];
  for (const one of found) {
    if (kept.length < MOST_STILLS && kept.every((other) => Math.abs(other.time - one.time) > apart)) kept.push(one);
  }
  kept.sort((one, two) => one.time - two.time);
  while (kept.length < MOST_STILLS) { // halve the longest gaps
    const gaps = kept.slice(1).map((one, i) => one.time - kept[i].time);
    const at = gaps.indexOf(Math.max(...gaps));
    kept.splice(at + 1, 0, { time: kept[at].time + 0.5 * gaps[at], name: "between" });
  }
  return kept;
}

class Stills {
  constructor(viewer) {
    this.viewer = viewer;
    this.items = moments().map((moment) => {
      const canvas = make("canvas");
      const button = make("button", { type: "button" }, canvas, make("b", {}, `${digits(moment.time, 3)} s`), moment.name);
      button.addEventListener("click", () => { clock.play(false); clock.set(moment.time); });
      byId("stills").append(button);
      return { ...moment, canvas, button };
    });
    clock.listen((time) => this.mark(time));
    new ResizeObserver(() => this.draw()).observe(byId("stills"));
  }

  mark(time) {
    for (const item of this.items) {
      item.button.setAttribute("aria-current", String(Math.abs(item.time - time) < 0.004 * (LAST - FIRST)));
    }
  }

  draw() {
    const { viewer } = this, camera = new THREE.PerspectiveCamera(FIELD), ratio = window.devicePixelRatio || 1;
    for (const { canvas, time } of this.items) {
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width) return;
      fit(camera, viewer.places, VIEWS.free, width / height, 0.88);
      viewer.render(camera, width, height, ratio, time);
      viewer.copyTo(canvas);
    }
    viewer.drawNow();
  }
}
