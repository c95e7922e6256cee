// The charts of all responses, their legend and their common zoom.

function offset(values, error, sign) {
  return values.map((value, i) => value + sign * error[i]);
}

// The bounds, without those whose error is so large that they are not to be relied on.
function drawable({ lower, upper, error, widest }) {
  const i = nearest(TIME, widest), most = error ? DATA.unsure * (upper[i] - lower[i]) : Infinity;
  const sure = (values) => values.map((value, at) => (error && error[at] >= most ? NaN : value));
  return { lower: sure(lower), upper: sure(upper) };
}

function responseChart(response, r, marks) {
  const { nominal, error } = response, { unit } = response, { lower, upper } = drawable(response);
  const areas = [{ lower, upper, kind: "band" }];
  const possible = (values) => values.map((value) => Math.min(response.most ?? Infinity, Math.max(response.least ?? -Infinity, value)));
  if (error) areas.unshift({ lower: possible(offset(lower, error, -1)), upper: possible(offset(upper, error, 1)), kind: "doubt" });
  const curves = DATA.lines.map(({ curves }) => ({ values: curves[r], kind: "thin" }));
  DATA.moving.slice(1).forEach(({ curves: ours }, i) => curves.push({ values: ours[r], kind: "moving", run: i + 1 }));
  curves.push({ values: lower, kind: "lower" }, { values: upper, kind: "upper" });
  if (nominal) curves.push({ values: nominal, kind: "nominal" });
  const readout = (i) => [
    ["bounds", `${digits(response.lower[i])} to ${digits(response.upper[i])}`],
    ["width", digits(response.upper[i] - response.lower[i], 3)],
    ...(error ? [["error ±", `${digits(error[i], 2)}${Number.isNaN(lower[i]) ? ", too large to draw them" : ""}`]] : []),
    ...(nominal ? [["nominal", digits(nominal[i])]] : []),
  ];
  const chart = new Chart({ title: response.longName, units: `${response.name}, ${unit}`, curves, areas, marks, along: response.along, readout });
  return Object.assign(chart, { trusted: { lower, upper } });
}

// A line or a patch with its name.
function key(name, attributes, patch = false) {
  const mark = patch ? `<rect width="22" height="10" ${attributes}/>` : `<path d="M0 5H22" ${attributes}/>`;
  const span = make("span");
  span.innerHTML = `<svg width="22" height="10" aria-hidden="true">${mark}</svg>`;
  span.append(name);
  return span;
}

function legend() {
  const items = [key("upper bound", 'class="curve upper"'), key("lower bound", 'class="curve lower"'), key("nominal run", 'class="curve nominal"')];
  if (DATA.moving.length > 1) items.push(key("runs that move, in their colours", 'class="curve moving" style="stroke:var(--third)"'));
  if (DATA.lines.length) items.push(key("runs that were not fitted", 'class="curve thin"'));
  items.push(key("between the bounds", 'class="band"', true));
  if (DATA.responses.some(({ error }) => error)) items.push(key("estimated error of the bounds", 'class="doubt"', true));
  if (DATA.whatIf?.slopes) items.push(key("what if", 'class="curve asked"'));
  byId("legend").append(...items);
}

function drawCharts() {
  const nominal = DATA.runs[DATA.moving.length ? DATA.moving[0].run : 0];
  const marks = closures(nominal).map(({ time }) => time);
  legend();
  const charts = DATA.responses.map((response, r) => responseChart(response, r, marks)), whole = byId("whole");
  byId("charts").append(...charts.map((chart) => chart.root));
  const zoom = ([from, to]) => {
    const least = 4 * ((LAST - FIRST) / TIME.length);
    const span = [Math.max(FIRST, from), Math.min(LAST, to)];
    if (span[1] - span[0] < least) return;
    whole.hidden = span[0] === FIRST && span[1] === LAST;
    for (const chart of charts) { chart.span = span; chart.draw(); }
  };
  for (const chart of charts) chart.zoom = zoom;
  whole.addEventListener("click", () => zoom([FIRST, LAST]));
  return charts;
}
