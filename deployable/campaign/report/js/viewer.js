// The picture that is turned by mouse, touch and keys, and its controls.

class Viewer {
  constructor(canvas, runs) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    Object.assign(this, { canvas, runs, byStress: false, names: true, moved: false });
    this.places = runs[0].places();
    const box = new THREE.Box3().setFromPoints(this.places);
    this.radius = 0.5 * box.getSize(new THREE.Vector3()).length() || 1;
    this.camera = new THREE.PerspectiveCamera(FIELD);
    this.furnish(box);
    this.listen();
    this.look("free");
    new ResizeObserver(() => this.resize()).observe(canvas);
    clock.listen(() => this.draw());
  }

  // Light, floor, and what each run is made of.
  furnish(box) {
    const middle = box.getCenter(new THREE.Vector3()), { radius } = this, scene = this.scene = new THREE.Scene();
    const sun = new THREE.DirectionalLight(0xffffff, 2.2), { shadow } = sun;
    sun.position.set(0.32, 0.82, 0.48).multiplyScalar(3 * radius).add(middle);
    sun.target.position.copy(middle);
    sun.castShadow = this.renderer.shadowMap.enabled = true;
    Object.assign(shadow.camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: radius, far: 6 * radius });
    shadow.mapSize.set(1024, 1024);
    shadow.radius = 4;
    this.step = roundStep(2.5 * radius, 12);
    const size = 2 * Math.ceil((1.25 * radius) / this.step) * this.step, low = box.min.y - 0.03 * radius;
    this.floor = new THREE.Mesh(new THREE.PlaneGeometry(size, size), new THREE.ShadowMaterial({ opacity: 0.16 }));
    this.floor.rotation.x = -Math.PI / 2;
    this.floor.receiveShadow = true;
    this.grid = new THREE.GridHelper(size, Math.round(size / this.step), 0xffffff, 0xffffff);
    for (const flat of [this.floor, this.grid]) flat.position.set(this.step * Math.round(middle.x / this.step), low, this.step * Math.round(middle.z / this.step));
    scene.add(sun, sun.target, new THREE.HemisphereLight(0xffffff, 0x777777, 1.9), this.floor, this.grid);
    this.runs.forEach((run, i) => {
      scene.add(run.root);
      const { bars, cables, pins } = run.meshes, faint = i ? { transparent: true, opacity: 0.14, depthWrite: false } : { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
      if (bars) {
        bars.material = new THREE.MeshStandardMaterial({ roughness: 0.75, ...faint });
        bars.castShadow = !i;
        run.outline = outlineOf(bars);
      }
      if (cables) cables.material = new THREE.MeshBasicMaterial({ vertexColors: true, side: 2, ...faint });
      if (pins) pins.visible = !i;
      for (const point of i ? [] : run.points) point.push(make("span", { class: "name", "aria-hidden": "true" }, point[0]));
    });
    this.canvas.parentNode.append(...this.runs[0].points.map(([, , name]) => name));
    this.recolour();
  }

  recolour() {
    this.grid.material.color.set(themeColour("--floor"));
    this.runs.forEach(({ meshes: { bars, pins }, outline }, i) => {
      if (pins) pins.material.color.set(themeColour("--pin"));
      if (!bars) return;
      bars.material.vertexColors = this.byStress && !i;
      bars.material.color.set(bars.material.vertexColors ? "#ffffff" : themeColour(i ? SHOWN.colour(i) : "--steel"));
      bars.material.needsUpdate = true;
      outline.material.color.set(themeColour(i ? SHOWN.colour(i) : "--edge"));
    });
  }

  // Bring the runs that are shown to a time.
  pose(time) {
    const rigid = new THREE.Color(themeColour("--steel")), slack = new THREE.Color(themeColour("--soft"));
    this.runs.forEach((run, i) => {
      run.root.visible = SHOWN.has(i);
      if (!run.root.visible) return;
      run.at(time);
      const { bars, cables } = run.meshes, { stress, tension } = run.loads;
      if (bars?.material.vertexColors) run.colour(bars, stress, (share) => (share === null ? rigid : scaleColour((share * stress.most) / this.top)));
      if (cables) run.colour(cables, tension, (share) => (share > 0 ? cableColour((share * tension.most) / MOTION.largestTension) : slack));
    });
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.drawNow(); });
  }

  // As large as it is on the page, or for paper.
  drawNow(ratio = window.devicePixelRatio || 1, width = this.canvas.clientWidth, height = this.canvas.clientHeight) {
    if (!width || !height) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render(this.camera, width, height, ratio, clock.time);
    this.placeNames(width, height);
    const { azimuth, elevation } = this.angles(), { x, y, z } = this.controls.target;
    const look = [azimuth, elevation, this.camera.position.distanceTo(this.controls.target), x, -z, y];
    Object.assign(this.canvas.dataset, { time: clock.time.toFixed(6), radius: this.radius.toFixed(6), look: look.map((value) => value.toFixed(4)).join(" ") });
    this.canvas.dataset.page = this.places.map((place) => place.clone().project(this.camera)).reduce((most, { x: a, y: b }) => Math.max(most, Math.abs(a), Math.abs(b)), 0).toFixed(4);
  }

  render(camera, width, height, ratio, time) {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.pose(time);
    this.grid.visible = this.floor.visible = camera === this.camera && camera.position.y > this.floor.position.y;
    this.renderer.render(this.scene, camera);
  }

  // Copy the picture, which browsers do not print as it was drawn last, to a canvas.
  copyTo(canvas) {
    Object.assign(canvas, { width: this.canvas.width, height: this.canvas.height });
    canvas.getContext("2d").drawImage(this.canvas, 0, 0);
  }

  // Names beside the points of the first run, away from their middle.
  placeNames(width, height) {
    const { points } = this.runs[0], seen = this.names && SHOWN.has(0);
    const flat = points.map(([, node]) => node.getWorldPosition(new THREE.Vector3()).project(this.camera));
    const middle = ["x", "y"].map((key) => flat.reduce((sum, place) => sum + place[key] / flat.length, 0));
    points.forEach(([, , name], i) => {
      let [right, up] = [(flat[i].x - middle[0]) * width, (flat[i].y - middle[1]) * height];
      const size = Math.hypot(right, up);
      if (size < 2) [right, up] = [0, 1]; else [right, up] = [right / size, up / size];
      name.hidden = !seen;
      name.style.left = `${(0.5 + 0.5 * flat[i].x) * width + 16 * right}px`;
      name.style.top = `${(0.5 - 0.5 * flat[i].y) * height - 16 * up}px`;
    });
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    if (this.moved) this.drawNow();
    else this.look(this.view);
  }

  look(view) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    Object.assign(this.controls, { minPolarAngle: 0, maxPolarAngle: Math.PI });
    this.controls.target.copy(fit(this.camera, this.places, VIEWS[view], width / height || 1, 0.8));
    this.controls.update();
    Object.assign(this, { view, moved: false });
    this.drawNow();
  }

  angles() {
    const { theta, phi } = new THREE.Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    return { azimuth: theta - Math.PI / 2, elevation: Math.PI / 2 - phi };
  }

  // Turn by angles (rad) and come nearer by a factor.
  turn(right, up, nearer = 1) {
    const place = new THREE.Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    place.theta -= right;
    place.phi = Math.min(Math.PI - 1e-4, Math.max(1e-4, place.phi - up));
    place.radius /= nearer;
    Object.assign(this.controls, { minPolarAngle: 0, maxPolarAngle: Math.PI });
    this.camera.position.setFromSpherical(place).add(this.controls.target);
    this.controls.update();
    this.moved = true;
    this.draw();
  }

  // Whether the picture has the focus: it is turned every way by a finger then, which else scrolls
  // the page up and down (`touch-action` in the style), and zoomed by the wheel.
  get held() {
    return document.activeElement === this.canvas;
  }

  listen() {
    const { canvas } = this, controls = this.controls = new THREE.OrbitControls(this.camera, canvas);
    canvas.style.touchAction = ""; // as the style has it
    controls.enableDamping = false;
    controls.addEventListener("start", () => { this.moved = true; });
    controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("pointerdown", ({ pointerType }) => {
      const level = Math.PI / 2 - this.angles().elevation, free = this.held || pointerType !== "touch";
      Object.assign(controls, { enableZoom: true, minPolarAngle: free ? 0 : level, maxPolarAngle: free ? Math.PI : level });
    }, { capture: true });
    canvas.addEventListener("click", () => canvas.focus({ preventScroll: true })); // not every browser does so itself
    canvas.addEventListener("wheel", ({ ctrlKey }) => { controls.enableZoom = ctrlKey || this.held; }, { capture: true });
    canvas.addEventListener("dblclick", () => this.look("free"));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1], "+": [0, 0, 1.15], "=": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (event.key === "0") this.look("free");
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

let markShown = () => {};

// Which runs are shown, the colours' meaning, views and zoom.
function viewerControls(viewer) {
  const boxes = DATA.moving.map((one, i) => {
    const box = make("input", { type: "checkbox" });
    box.addEventListener("change", () => { SHOWN.set(i, box.checked); markShown(); showRuns(); });
    byId("runs-shown").append(make("label", { title: runText(one) }, box, one.label.split(", ")[0]));
    return box;
  });
  markShown = () => boxes.forEach((box, i) => {
    box.checked = SHOWN.has(i);
    box.style = `color:var(${SHOWN.colour(i)});accent-color:var(${SHOWN.colour(i)})`;
  });
  markShown();
  byId("few").hidden = boxes.length <= COLOURS.length + 1;
  const [{ loads, meshes }] = viewer.runs, gradient = (colourOf) => `background:linear-gradient(90deg,${[0, 0.25, 0.5, 0.75, 1].map((share) => `#${colourOf(share).getHexString()}`).join(",")})`;
  if (meshes.cables) {
    byId("runs-shown").append(make("span", { id: "cables" }, "cables and struts 0 ", make("i", { style: gradient(cableColour) }), ` ${digits(MOTION.largestTension, 3)} N, grey: no force`));
  }
  byId("coloured").hidden = !MOTION.largestStress; // of rigid bodies only
  viewer.top = usualTop(loads.stress);
  byId("scale").append("largest stress of an element (von Mises)", make("i", { style: gradient(scaleColour) }),
    make("span", {}, make("b", {}, "0"), make("b", {}, `${viewer.top < MOTION.largestStress ? "≥ " : ""}${digits(viewer.top / 1e6, 2)} MPa`)));
  byId("colour").addEventListener("change", ({ target }) => {
    viewer.byStress = target.value === "stress";
    byId("scale").hidden = !viewer.byStress;
    repaint();
  });
  for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => viewer.look(button.dataset.view));
  byId("closer").addEventListener("click", () => viewer.turn(0, 0, 1.25));
  byId("farther").addEventListener("click", () => viewer.turn(0, 0, 0.8));
  byId("names").addEventListener("change", ({ target }) => { viewer.names = target.checked; viewer.draw(); });
  byId("floor").textContent = `floor grid ${digits(viewer.step * DATA.metre.value)} ${DATA.metre.units}`;
}

// What a shown run is, in full.
function runText({ run, label }) {
  return `${label}: run ${DATA.runs[run].id}, ${parametersOf(run)}`;
}

const parametersOf = (run) => DATA.parameters.map(({ name, unit }, k) => `${name} = ${digits(DATA.runs[run].values[k], 4)} ${unit}`).join(", ");

// The stress (Pa) where the colours end: all but one in two hundred values of the first run are below.
function usualTop(stress) {
  if (!stress) return 1;
  const values = Uint16Array.from(stress.shares).sort(), usual = (values[Math.floor(0.995 * (values.length - 1))] / 65535) * stress.most;
  return usual > 0.7 * MOTION.largestStress || usual <= 0 ? MOTION.largestStress || 1 : usual;
}
