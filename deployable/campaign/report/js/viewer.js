// The picture that is turned by mouse, touch and keys, and its controls.

class Viewer {
  constructor(canvas, painter) {
    this.canvas = canvas;
    this.painter = painter;
    this.camera = new Camera(painter.extent);
    this.options = { byStress: false, names: true };
    this.pointers = new Map();
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
    clock.listen(() => this.draw());
  }

  draw(ratio = window.devicePixelRatio || 1) {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.drawNow(ratio); });
  }

  // Draw for a canvas of `width` x `height`; as large as it is on the page, if nothing is said.
  drawNow(ratio, width = this.canvas.clientWidth, height = this.canvas.clientHeight) {
    if (!width || !height) return;
    const wide = Math.round(width * ratio), high = Math.round(height * ratio);
    if (this.canvas.width !== wide || this.canvas.height !== high) Object.assign(this.canvas, { width: wide, height: high });
    const context = this.canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const fill = width === this.canvas.clientWidth ? undefined : 0.82; // on paper
    this.painter.paint(context, this.camera, width, height, clock.time, { ...this.options, fill });
    context.fillStyle = this.painter.soft;
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "left";
    context.fillText(`floor grid ${digits(this.painter.gridStep())} m`, 14, height - 12);
    context.textAlign = "right";
    if (width === this.canvas.clientWidth) context.fillText(this.hint(), width - 14, height - 12);
    const { radius, size } = this.painter.extent, { azimuth, elevation, zoom, shift } = this.camera;
    Object.assign(this.canvas.dataset, { time: clock.time.toFixed(6), radius: radius.toFixed(6), pin: size.toFixed(6) });
    this.canvas.dataset.look = [azimuth, elevation, zoom, ...shift].map((value) => value.toFixed(4)).join(" ");
  }

  // Whether the picture has the focus: it is turned every way by a finger then, which else scrolls
  // the page up and down (`touch-action` in the style).
  get held() {
    return document.activeElement === this.canvas;
  }

  hint() {
    if (!matchMedia("(pointer: coarse)").matches) return "drag to turn, + − to zoom";
    return this.held ? "drag to turn, pinch to zoom" : "tap it to turn it every way";
  }

  look(name) {
    this.camera.look(name);
    this.draw();
  }

  magnify(factor) {
    this.camera.magnify(factor);
    this.draw();
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
      this.start = [event.clientX, event.clientY];
    });
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    canvas.addEventListener("pointerup", ({ clientX, clientY }) => { // not every browser does so itself
      if (this.start && Math.hypot(clientX - this.start[0], clientY - this.start[1]) < 6) canvas.focus({ preventScroll: true });
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    }
    // The wheel scrolls the page unless the picture was clicked or a zoom is meant.
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !this.held) return;
      event.preventDefault();
      this.magnify(Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
    for (const name of ["focus", "blur"]) canvas.addEventListener(name, () => this.draw());
    canvas.addEventListener("dblclick", () => this.look("free"));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before[0], dy = event.clientY - before[1];
    if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const size = (x, y) => Math.hypot(x - other[0], y - other[1]) || 1;
      this.camera.magnify(size(event.clientX, event.clientY) / size(...before));
      this.move(0.5 * dx, 0.5 * dy);
    } else if (event.shiftKey || event.buttons === 4) this.move(dx, dy);
    else this.camera.turn(0.009 * dx, event.pointerType === "touch" && !this.held ? 0 : 0.009 * dy);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.draw();
  }

  move(dx, dy) {
    this.camera.shift[0] += dx / this.camera.zoom;
    this.camera.shift[1] += dy / this.camera.zoom;
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (turns[event.key]) this.camera.turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") this.camera.magnify(1.15);
    else if (event.key === "-") this.camera.magnify(1 / 1.15);
    else if (event.key === "0") this.camera.look("free");
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.draw();
  }
}

// Which runs are shown, the colours' meaning, views and zoom.
function viewerControls(viewer) {
  const { options, painter } = viewer;
  const boxes = DATA.moving.map((one, i) => {
    const box = make("input", { type: "checkbox" });
    box.addEventListener("change", () => { SHOWN.set(i, box.checked); mark(); showRuns(); });
    byId("runs-shown").append(make("label", { title: runText(one) }, box, one.label));
    return box;
  });
  const mark = () => boxes.forEach((box, i) => {
    box.checked = SHOWN.has(i);
    box.style = `color:var(${SHOWN.colour(i)});accent-color:var(${SHOWN.colour(i)})`;
  });
  mark();
  byId("few").hidden = boxes.length <= COLOURS.length + 1;
  if (MOTION.cables) byId("runs-shown").append(cableKey());
  byId("coloured").hidden = !MOTION.largestStress; // of rigid bodies only
  painter.topShare = 1;
  byId("colour").addEventListener("change", ({ target }) => {
    options.byStress = target.value === "stress";
    byId("scale").hidden = !options.byStress;
    viewer.draw();
    stills.draw();
  });
  const stops = SCALE.map((colour) => `rgb(${colour.join(",")})`).join(",");
  const top = usualTop();
  painter.topShare = top;
  const ends = make("span", {}, make("b", {}, "0"), make("b", {}, `${top < 1 ? "≥ " : ""}${digits(top * MOTION.largestStress / 1e6, 2)} MPa`));
  byId("scale").append("largest stress of an element (von Mises)", make("i", { style: `background:linear-gradient(90deg,${stops})` }), ends);
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => viewer.look(button.dataset.view));
  }
  byId("closer").addEventListener("click", () => viewer.magnify(1.25));
  byId("farther").addEventListener("click", () => viewer.magnify(0.8));
  byId("names").addEventListener("change", ({ target }) => { options.names = target.checked; viewer.draw(); });
}

// What the lines of the cables mean.
function cableKey() {
  const stops = [0, 0.5, 1].map((share) => `rgb(${cableColour(share).join(",")})`).join(",");
  const bar = make("i", { style: `display:inline-block;width:60px;height:6px;border-radius:3px;background:linear-gradient(90deg,${stops})` });
  return make("span", { id: "cables" }, "cables 0 ", bar, ` ${digits(MOTION.cables.most, 3)} N, dashed: slack`);
}

// What a shown run is, in full.
function runText({ run, label }) {
  const values = DATA.parameters.map(({ name, units }, k) => `${name} = ${digits(DATA.runs[run].values[k], 6)} ${pretty(units)}`);
  return `${label}: run ${DATA.runs[run].id}, ${values.join(", ")}`;
}

// The share of the largest stress where the colours end: all but one in two hundred values are below.
function usualTop() {
  const values = Float64Array.from(MOTION.runs[0].stress).sort();
  const usual = values[Math.floor(0.995 * (values.length - 1))] / 65535;
  return usual > 0.7 || usual <= 0 ? 1 : usual;
}
