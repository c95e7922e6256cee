// Scales, ticks and paths of the curves, which are SVG so that they print sharp.

const SVG = "http://www.w3.org/2000/svg";

function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

function ticks(low, high, parts) {
  const step = roundStep(high - low, parts), out = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) out.push(i * step);
  const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return out.map((value) => [value, value.toFixed(Math.min(places, 12)).replace("-", "−")]);
}

// Indices from..to (inclusive) of TIME in a span, one further on either side.
function spanOf([from, to]) {
  return [below(TIME, from), Math.min(TIME.length - 1, below(TIME, to) + 1)];
}

// Points "x,y" of a curve, the least and largest of each pixel where there are many; null for where
// it has no numbers.
function points(values, span, x, y) {
  const [from, to] = spanOf(span), out = [];
  const bins = Math.max(1, Math.ceil((x(TIME[to]) - x(TIME[from])) / 0.7)), each = (to - from + 1) / bins;
  const put = (i) => out.push(Number.isNaN(values[i]) ? null : `${x(TIME[i]).toFixed(1)},${y(values[i]).toFixed(1)}`);
  if (each <= 2) {
    for (let i = from; i <= to; i++) put(i);
    return out;
  }
  for (let bin = 0; bin < bins; bin++) {
    const start = from + Math.floor(bin * each), stop = Math.min(to, from + Math.floor((bin + 1) * each) - 1);
    let low = start, high = start;
    for (let i = start; i <= stop; i++) {
      if (Number.isNaN(values[i])) continue;
      if (!(values[i] >= values[low])) low = i; // also where there was no number so far
      if (!(values[i] <= values[high])) high = i;
    }
    put(Math.min(low, high));
    if (low !== high) put(Math.max(low, high));
  }
  return out;
}

// Points in the pieces that lie between gaps.
function pieces(...curve) {
  const found = [[]];
  for (const point of points(...curve)) {
    if (point === null) found.push([]); else found[found.length - 1].push(point);
  }
  return found.filter((piece) => piece.length);
}

// A curve, with gaps where it has no numbers.
const line = (...curve) => pieces(...curve).map((piece) => `M${piece.join("L")}`).join("");

// The outline of the area between two curves, whose gaps are the same.
function area(one, two, ...rest) {
  const back = pieces(two, ...rest);
  return pieces(one, ...rest).map((piece, i) => `M${piece.join("L")}L${back[i].reverse().join("L")}Z`).join("");
}
