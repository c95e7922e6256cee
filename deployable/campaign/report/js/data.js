// The page's data, and small helpers that all files use.

// What a script element holds compressed, as an ArrayBuffer.
function inflate(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

// The library as a script of its own, which declares THREE.
document.head.append(make("script", {}, new TextDecoder().decode(await inflate("library"))));

const KINDS = { f8: Float64Array, f4: Float32Array, u1: Uint8Array };

// The page's data are text of so many bytes and, after it, the arrays that the text points to.
function unpack(value, bytes) {
  if (typeof value?.at === "number") return new KINDS[value.kind](bytes, value.at, value.count);
  if (value && typeof value === "object") for (const key of Object.keys(value)) value[key] = unpack(value[key], bytes);
  return value;
}

const BYTES = await inflate("data");
const [SIZE] = new Uint32Array(BYTES, 0, 1);
const DATA = unpack(JSON.parse(new TextDecoder().decode(new Uint8Array(BYTES, 4, SIZE))), BYTES.slice(4 + SIZE));
const MOTION = DATA.motion;
const TIME = DATA.time;
const FIRST = TIME[0];
const LAST = TIME[TIME.length - 1];

const byId = (id) => document.getElementById(id);

function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const COLOURS = ["--low", "--high", "--third", "--fourth", "--fifth", "--sixth"];

// Which of the moving runs are shown: the first one or not, and as many others as there are colours
// that can be told apart.
class Shown {
  constructor(count) {
    this.first = true;
    this.places = COLOURS.map((_, k) => (k + 1 < count ? k + 1 : null)); // the run of each colour
    this.order = this.places.filter((run) => run !== null); // the longest shown first
  }

  has(run) {
    return run === 0 ? this.first : this.places.includes(run);
  }

  // Show a run or not; where no colour is free, the longest shown makes room.
  set(run, on) {
    if (run === 0) this.first = on;
    if (run === 0 || on === this.has(run)) return;
    const hide = (one) => {
      this.places[this.places.indexOf(one)] = null;
      this.order = this.order.filter((other) => other !== one);
    };
    if (!on) return hide(run);
    if (this.order.length === COLOURS.length) hide(this.order[0]);
    const usual = (run - 1) % COLOURS.length;
    this.places[this.places[usual] === null ? usual : this.places.indexOf(null)] = run;
    this.order.push(run);
  }

  colour(run) {
    return run === 0 ? "--ink" : COLOURS[this.places.indexOf(run)] ?? "--soft";
  }
}

const SHOWN = new Shown(DATA.moving.length);

const themeColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Index of the last entry of a sorted array that is not above the value.
function below(sorted, value) {
  let low = 0, high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (sorted[middle] <= value) low = middle; else high = middle - 1;
  }
  return low;
}

// Index of the entry of a sorted array that is nearest to the value.
function nearest(sorted, value) {
  const index = below(sorted, value);
  const next = Math.min(index + 1, sorted.length - 1);
  return Math.abs(sorted[next] - value) < Math.abs(sorted[index] - value) ? next : index;
}

function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "";
  const text = Number(value.toPrecision(count));
  const size = Math.abs(text);
  return (size !== 0 && (size < 1e-5 || size >= 1e6) ? text.toExponential(count - 1) : String(text)).replaceAll("-", "−");
}

// A number to the place of the first digit of its error, with that: `0.062 ± 0.005`.
function measured(value, error) {
  const places = error > 1e-3 * Math.abs(value) ? -Math.floor(Math.log10(error)) : NaN;
  return places >= 0 && places < 10 ? `${value.toFixed(places)} ± ${error.toFixed(places)}`.replaceAll("-", "−") : digits(value, 3);
}

// A round step (1, 2 or 5 times a power of ten) that divides a span into about `parts`.
function roundStep(span, parts) {
  const raw = span / parts, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}

// Moments at which contacts shut in a run: [{time, names}], those within a hundredth of the time
// as one.
function closures(run) {
  const moments = [];
  for (const event of run.events.filter((one) => one.closing)) {
    const last = moments[moments.length - 1];
    if (last && event.time - last.time < 0.01 * (LAST - FIRST)) last.names.add(event.contact);
    else moments.push({ time: event.time, names: new Set([event.contact]) });
  }
  return moments.map(({ time, names }) => ({ time, names: [...names].join(", ") }));
}
