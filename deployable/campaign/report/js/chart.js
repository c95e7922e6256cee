// One chart: curves over time with cursor, values, zoom.

const MARGIN = { left: 52, right: 10, top: 12, bottom: 22 };

// So high that the charts of all responses, two in a row, are together about as high as a window, within reason.
function usualHeight() {
  return Math.min(340, Math.max(170, (innerHeight - 180) / Math.ceil(DATA.responses.length / 2) - 65));
}

class Chart {
  // curves: [{values, kind, run}], of a run that moves only while it is shown; areas: [{lower, upper, kind}]; readout(index) -> [[name, text]]
  constructor({ title, units, curves, areas = [], marks = [], along, readout }) {
    Object.assign(this, { title, units, height: usualHeight(), curves, areas, marks: along ? [] : marks, timeless: Boolean(along), along: along ?? { words: "t", unit: "s", first: FIRST, last: LAST }, readout });
    this.values = make("p", { class: "readout" });
    this.svg = svg("svg", { role: "img", tabindex: "0", preserveAspectRatio: "xMinYMin", "aria-label": `${title} over ${along ? along.words : "time"}` });
    this.root = make("div", { class: "chart" }, make("h3", {}, title, make("span", {}, `(${units})`)), this.values, this.svg);
    this.zoom = () => {};
    this.span = [FIRST, LAST];
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.root);
    clock.listen((time) => this.follow(time));
  }

  drawn() {
    return this.curves.filter(({ run }) => run === undefined || SHOWN.has(run));
  }

  // Least and largest value in the span of what is drawn; what is not known is cut there.
  range() {
    const [from, to] = spanOf(this.span);
    let low = Infinity, high = -Infinity;
    for (const values of [...this.drawn().map((c) => c.values), ...this.areas.filter(({ kind }) => kind === "band").flatMap((a) => [a.lower, a.upper])]) {
      for (let i = from; i <= to; i++) {
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
    }
    if (low > high) [low, high] = [0, 0]; // all of it is too uncertain
    const room = 0.05 * (high - low) || 0.5 * Math.abs(high) || 1;
    return [low - room, high + room];
  }

  // Draw as wide as there is room, or for a page of `paper` pixels.
  draw(paper) {
    const width = paper ?? this.root.clientWidth;
    if (!width || (this.onPaper && !paper)) return;
    this.width = width;
    const { left, right, top, bottom } = MARGIN, [from, to] = this.span, [low, high] = this.range();
    const tall = paper ? 0.72 * Math.min(230, this.height) : this.height, inner = width - left - right, base = tall - bottom;
    this.x = (t) => left + (inner * (t - from)) / (to - from);
    this.y = (v) => base - ((base - top) * (v - low)) / (high - low);
    const id = `clip-${this.title.replace(/\W/g, "-")}`;
    const clip = svg("clipPath", { id }, svg("rect", { x: left, y: 0, width: inner, height: base }));
    this.svg.setAttribute("viewBox", `0 0 ${width} ${tall}`);
    this.svg.style.height = `${tall}px`;
    const inside = svg("g", { "clip-path": `url(#${id})` });
    for (const { lower, upper, kind } of this.areas) {
      inside.append(svg("path", { class: kind, d: area(lower, upper, this.span, this.x, this.y) }));
    }
    for (const mark of this.marks) {
      inside.append(svg("line", { class: "event", x1: this.x(mark), x2: this.x(mark), y1: top, y2: base }));
    }
    for (const { values, kind, run } of this.drawn()) {
      const style = run ? `stroke:var(${SHOWN.colour(run)})` : "";
      inside.append(svg("path", { class: `curve ${kind}`, style, d: line(values, this.span, this.x, this.y) }));
    }
    this.asked = svg("path", { class: "curve asked" });
    inside.append(this.asked);
    this.ask(this.what);
    this.cursor = svg("line", { class: "cursor", y1: top - 6, y2: base });
    this.hovered = svg("line", { class: "hover", y1: top, y2: base, visibility: "hidden" });
    this.chosen = svg("rect", { class: "chosen", y: top, height: base - top, width: 0 });
    inside.append(this.chosen, this.hovered, this.cursor);
    this.svg.replaceChildren(clip, this.axes(low, high, base), inside);
    this.follow(clock.time);
  }

  // Draw the curve that sliders ask for.
  ask(values) {
    this.what = values;
    if (!this.asked) return;
    this.asked.curve = values;
    this.asked.setAttribute("d", values ? line(values, this.span, this.x, this.y) : "");
  }

  axes(low, high, base) {
    const group = svg("g"), { left, right } = MARGIN;
    for (const [value, text] of ticks(low, high, 5)) {
      const y = this.y(value);
      group.append(svg("line", { class: "grid", x1: left, x2: this.width - right, y1: y, y2: y }));
      group.append(svg("text", { x: left - 8, y: y + 4, "text-anchor": "end" }, text));
    }
    const ends = this.span.map((time) => this.place(time)).sort((a, b) => a - b), { first, last, unit } = this.along;
    for (const [value, text] of ticks(...ends, Math.max(3, Math.min(10, this.width / 90)))) {
      const x = this.x(FIRST + ((LAST - FIRST) * (value - first)) / (last - first));
      if (x > this.width - right - 8 - 6 * unit.length) continue; // room for the unit
      group.append(svg("text", { x, y: base + 16, "text-anchor": "middle" }, value === 0 ? "0" : text));
    }
    group.append(svg("text", { x: this.width - right, y: base + 16, "text-anchor": "end", class: "unit" }, unit));
    return group;
  }

  // What a time stands for: itself, or what the response lies along.
  place(time) {
    const { first, last } = this.along;
    return first + ((last - first) * (time - FIRST)) / (LAST - FIRST);
  }

  // The moment at which the lower bound is least, where no moment of the motion is meant.
  least() {
    const { values } = this.curves.find(({ kind }) => kind === "lower") ?? this.curves[0];
    return TIME[Math.max(0, values.indexOf(values.reduce((a, b) => Math.min(a, b))))];
  }

  follow(time) {
    if (!this.cursor) return;
    if (this.timeless) time = this.least();
    const at = this.x(time).toFixed(1);
    this.cursor.setAttribute("x1", at);
    this.cursor.setAttribute("x2", at);
    if (!this.hovering) this.tell(time);
  }

  tell(time) {
    const parts = this.readout(nearest(TIME, time));
    this.values.replaceChildren(...[[this.along.words, `${digits(this.place(time), 4)} ${this.along.unit}`], ...parts].map(([name, text]) => make("span", {}, `${name} `, make("b", {}, text))));
  }

  timeAt(event) {
    const box = this.svg.getBoundingClientRect(), { left, right } = MARGIN;
    const share = (event.clientX - box.left - left) / (this.width - left - right);
    return this.span[0] + Math.min(1, Math.max(0, share)) * (this.span[1] - this.span[0]);
  }

  listen() {
    const node = this.svg;
    node.addEventListener("pointerdown", (event) => { this.start = this.timeAt(event); node.setPointerCapture(event.pointerId); });
    node.addEventListener("pointermove", (event) => this.hover(event));
    node.addEventListener("pointerup", (event) => this.release(event));
    node.addEventListener("pointerleave", () => { this.hovering = false; this.hovered?.setAttribute("visibility", "hidden"); this.follow(clock.time); });
    node.addEventListener("pointercancel", () => { this.start = null; this.chosen.setAttribute("width", 0); });
    node.addEventListener("dblclick", () => this.zoom([FIRST, LAST]));
    node.addEventListener("keydown", (event) => {
      const span = this.span[1] - this.span[0];
      if (event.key === "+" || event.key === "=") this.zoom([clock.time - 0.3 * span, clock.time + 0.3 * span]);
      else if (event.key === "-") this.zoom([clock.time - span, clock.time + span]);
      else if (event.key === "0") this.zoom([FIRST, LAST]);
    });
  }

  hover(event) {
    const time = this.timeAt(event), at = this.x(time);
    this.hovering = true;
    this.hovered.setAttribute("visibility", "visible");
    this.hovered.setAttribute("x1", at);
    this.hovered.setAttribute("x2", at);
    if (this.start != null) {
      this.chosen.setAttribute("x", Math.min(at, this.x(this.start)));
      this.chosen.setAttribute("width", Math.abs(at - this.x(this.start)));
    }
    this.tell(time);
  }

  release(event) {
    if (this.start == null) return;
    const time = this.timeAt(event), from = Math.min(time, this.start), to = Math.max(time, this.start);
    const wide = Math.abs(this.x(time) - this.x(this.start)) > 8;
    this.start = null;
    this.chosen.setAttribute("width", 0);
    if (wide) this.zoom([from, to]);
    else if (!this.timeless) { clock.play(false); clock.set(time); }
  }
}
