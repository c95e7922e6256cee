// What if: sliders ask what was fitted, as `intervals/formula.py` does, and the nearest run that moves.

const KERNELS = { cube: (d) => d ** 3, fading: (d) => Math.exp(-d), matern: (d) => (1 + d + (d * d) / 3) * Math.exp(-d) };

// Chebyshev products at unit coordinates.
const products = (indices, unit) => indices.map((powers) => powers.reduce((product, n, j) => (n ? product * Math.cos(n * Math.acos(unit[j])) : product), 1));

function evaluate({ indices, coefficients, points, scales, weights, kernel, root, root_scale }, unit) {
  if (root) unit = [...unit, 2 * Math.sqrt(Math.min(1, Math.max(0, evaluate(root, unit) / root_scale))) - 1];
  let sum = products(indices, unit).reduce((total, value, m) => total + value * coefficients[m], 0);
  for (let n = 0; n < weights.length; n++) {
    const square = unit.reduce((total, x, j) => total + (scales[j] * (x - points[n * unit.length + j])) ** 2, 0);
    sum += weights[n] * KERNELS[kernel](Math.sqrt(square));
  }
  return sum;
}

// A quantity, not a number where there is none.
function answer({ value, there, least, latest }, unit) {
  if (!value || !(typeof there === "boolean" ? there : evaluate(there, unit) >= 0)) return NaN;
  return Math.min(latest ?? Infinity, Math.max(least ?? -Infinity, evaluate(value, unit)));
}

const keeps = ({ kind, level }, value) => (kind === "happens" ? Number.isNaN(value) !== level : kind === "at_most" ? value <= level : value >= level);

// Whether a value is nearer to a limit than its error, so that the surrogate does not decide.
const isAtLimit = ({ kind, level }, value, error) => kind !== "happens" && Math.abs(value - level) <= (error ?? 0);

class WhatIf {
  constructor({ quantities, limits, indices, constants, slopes, left, misfit, choice }) {
    Object.assign(this, { quantities, limits, indices, constants, slopes, left, misfit, choice, shown: null });
    this.parameters = choice?.parameters ?? DATA.parameters; // with a choice as far as its runs went
    this.sliders = this.parameters.map(({ name, unit, lower, nominal, upper, value, description }, j) => {
      const { lower: low, upper: high } = DATA.parameters[j] ?? { lower: nominal, upper: nominal };
      const marks = make("datalist", { id: `marks-${j}` }, ...[low, high, value].filter((mark) => mark !== undefined).map((mark) => make("option", { value: mark })));
      const input = make("input", { type: "range", min: lower, max: upper, step: "any", "aria-label": description || name });
      if (choice) input.setAttribute("list", marks.id);
      const output = make("output");
      input.value = nominal;
      input.disabled = !(upper > lower);
      input.addEventListener("input", () => this.ask());
      byId("sliders").append(make("label", {}, make("span", {}, make("b", {}, name), ` ${description}`), input, output, marks));
      return { input, output, unit: unit === "1" ? "" : unit };
    });
    this.tell(this.values());
    const nominal = this.parameters.map((parameter) => parameter.nominal);
    byId("usual").addEventListener("click", () => this.set(nominal));
    if (choice) {
      const button = make("button", { type: "button", id: "chosen-values" }, choice.kept ? "Best choice" : "Nearest choice");
      button.addEventListener("click", () => this.set(this.parameters.map(({ value }, j) => value ?? nominal[j])));
      byId("usual").after(button);
      for (const mark of document.querySelectorAll("[data-choice]")) {
        const values = JSON.parse(mark.dataset.choice);
        mark.addEventListener("click", () => this.set(this.parameters.map(({ name }, j) => values[name] ?? nominal[j])));
      }
    }
    for (const mark of document.querySelectorAll("[data-judged]")) mark.addEventListener("click", () => this.run(Number(mark.dataset.judged)));
    if (!DATA.judged) return;
    const number = make("input", { type: "number", min: 1, max: DATA.judged.met.length, "aria-label": "Run" });
    number.addEventListener("input", () => { if (number.checkValidity() && number.value) this.run(number.value - 1); });
    byId("usual").after(make("label", { class: "choice" }, "run ", number, ` of ${DATA.judged.met.length}`));
    this.number = number;
  }

  // Say what the sliders ask for.
  tell(values) {
    this.sliders.forEach(({ input, output, unit }, j) => {
      output.textContent = `${digits(values[j], 3)} ${unit}`;
      input.setAttribute("aria-valuetext", output.textContent);
    });
  }

  // Say what the measured curves say of the sliders' values: nothing outside the intervals that they leave explains them;
  // and by how many bands the nearest curve deviates.
  compare(values, unit) {
    const out = DATA.parameters.filter(({ name }, j) => !this.left[name] || values[j] < this.left[name][0] || values[j] > this.left[name][1]);
    const none = Object.values(this.left).every((ends) => !ends);
    const deviation = ` Their curve deviates by about ${digits(Math.exp(evaluate(this.misfit, unit)), 1)} bands.`;
    byId("what-tests").textContent = (none ? "The measured curves leave nothing of the box." : out.length ? `The measured curves exclude this: ${out.map(({ name }) => name).join(", ")}.` : "Within the intervals that the measured curves leave.") + deviation;
  }

  values() {
    return this.sliders.map(({ input }) => Number(input.value));
  }

  // Unit coordinates of values, in the box or, with a choice, in what its runs span.
  unit(values, parameters = DATA.parameters) {
    return parameters.map(({ lower, upper }, j) => (upper > lower ? Math.min(1, Math.max(-1, (2 * (values[j] - lower)) / (upper - lower) - 1)) : 0));
  }

  // The parameters whose values lie beyond the box, or that are fixed there.
  beyond(values) {
    return this.parameters.filter(({ nominal }, j) => {
      const { lower, upper } = DATA.parameters[j] ?? { lower: nominal, upper: nominal }, room = 1e-9 * Math.abs(upper);
      return values[j] < lower - room || values[j] > upper + room;
    });
  }

  set(values, run = null) {
    this.sliders.forEach(({ input }, j) => { input.value = values[j] ?? this.parameters[j].nominal; });
    this.ask(run);
  }

  // Show a run that was judged, by its number.
  run(index) {
    const { values } = DATA.judged, k = DATA.parameters.length;
    this.set([...values.subarray(k * index, k * (index + 1))], index);
    for (const mark of document.querySelectorAll("[data-judged]")) mark.classList.toggle("asked", Number(mark.dataset.judged) === index);
  }

  // A response over time at unit coordinates, within its bounds and where these are drawn.
  curve(r, unit) {
    const values = Float64Array.from(this.constants[r]), { lower, upper } = charts[r].trusted;
    products(this.indices, unit).forEach((factor, m) => { const slope = this.slopes[r][m]; for (let i = 0; i < values.length; i++) values[i] += factor * slope[i]; });
    return values.map((value, i) => Math.min(upper[i], Math.max(lower[i], value)));
  }

  ask(run = null) {
    const values = this.values(), unit = this.unit(values), q = this.quantities.length;
    const beyond = this.choice ? this.beyond(values) : [], model = beyond.length ? this.choice.quantities : this.quantities;
    const place = beyond.length ? this.unit(values, this.parameters) : unit;
    this.tell(values);
    if (this.number) this.number.value = run === null ? "" : run + 1;
    const numbers = run === null ? model.map((one) => answer(one, place)) : [...DATA.judged.numbers.subarray(q * run, q * (run + 1))];
    const index = ({ quantity }) => this.quantities.findIndex(({ name }) => name === quantity);
    const names = (limits) => [...new Set(limits.map(({ of }) => of))];
    const near = run === null ? this.limits.filter((limit) => isAtLimit(limit, numbers[index(limit)], model[index(limit)].error)) : [];
    const broken = names(this.limits.filter((limit) => !near.includes(limit) && !keeps(limit, numbers[index(limit)])));
    const [mark, verdict] = broken.length ? ["bad", `Fails: ${broken.join(", ")}`] : near.length ? ["", `About at the limit: ${names(near).join(", ")}`] : ["good", "Meets all requirements"];
    const basis = run !== null ? "simulated" : beyond.length ? `by the fit to the runs of the choice, ${beyond.map(({ name }) => name).join(", ")} beyond the box` : "by the fit";
    byId("what-verdict").replaceChildren(...(this.limits.length ? [make("b", { class: mark }, verdict), ` (${basis}).`] : []));
    byId("what-numbers").replaceChildren(...model.flatMap(({ name, words, unit: of, latest, error }, i) => {
      const late = run === null && latest !== null && numbers[i] >= latest;
      const text = Number.isNaN(numbers[i]) ? "does not happen" : late ? `not within ${digits(latest)} s` : `${measured(numbers[i], run === null ? error : 0)}${of === "1" ? "" : ` ${of}`}`;
      return [make("dt", {}, `${words[0].toUpperCase()}${words.slice(1)} (${name})`), make("dd", {}, text)];
    }));
    if (this.slopes) DATA.responses.forEach((_, r) => charts[r].ask(beyond.length ? null : this.curve(r, unit)));
    if (this.left && !beyond.length) this.compare(values, unit);
    else byId("what-tests").textContent = "";
    clearTimeout(this.later);
    this.later = setTimeout(() => this.nearest(unit), 20); // after the numbers and curves are painted
    Object.assign(byId("what-if").dataset, { numbers: JSON.stringify(numbers.map((value) => (Number.isNaN(value) ? null : value))) });
  }

  // Show the moving run that is nearest beside the first, and no other.
  nearest(unit) {
    const apart = DATA.moving.map(({ run }) => Math.max(...this.unit(DATA.runs[run].values).map((x, j) => Math.abs(x - unit[j]))));
    const near = apart.indexOf(Math.min(...apart));
    if (near < 0 || near === this.shown) return;
    this.shown = near;
    DATA.moving.forEach((_, i) => SHOWN.set(i, i === 0 || i === near));
    markShown();
    showRuns(false);
    byId("what-moves").textContent = `The structure that moves: ${near ? "the nearest run that has a motion, beside the nominal one" : "the nominal run"} (${parametersOf(DATA.moving[near].run)}).`;
  }
}
