"""Run a structure and its images, and tell which do not move alike.

What is the same arithmetic but for rounding must agree to `ROUNDING`, and to what numbers of the
structure that differ by `NUDGE` change, `GROWTH` times: where that is much, the motion hangs on
rounding (something catches, sticks or slackens just so), and the pair says nothing. What is the
same to the order of the step must agree within `ORDER` times what half the step changes, and so
must what is read off amid a step (`LATCH_KINDS`)."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from evidence.attack.metamorphic.families import DELAY, FAMILIES, delay
from evidence.attack.metamorphic.image import Image
from evidence.attack.metamorphic.runs import INSTANTS, STEPS, Curves, Run, simulate
from evidence.attack.metamorphic.structure_text import Structure, map_numbers

ROUNDING = 1e-6
"""Of the largest value: hinges close to 2e-11 m and 2e-10 rad in a step, over some
hundred steps."""

NUDGE, GROWTH, NUDGES = 1e-9, 100.0, 3
SENSITIVE = 1e-4
"""What a nudge may change of the largest value; a pair whose nudges change more says nothing."""

ORDER = 3.0
"""The error of a first-order method is twice what half the step changes, on both sides."""

LATCH_KINDS = frozenset(
    f"{prefix}latch_{kind}" for prefix in ("", "slide_") for kind in ("rate", "impact", "impulse")
)
"""Of the instant at which a latch catches: interpolated in the step, from the axes of a side."""

IMBALANCE = "the energy balance has an error"
"""By more than all there is: the scale is wrong, or energy comes from nowhere."""

UNRELIABLE_STARTS = frozenset({"motor_moment", "slide_motor_force"})
"""Of exact motors: at the first instant they follow from half a step before it, in the axes of a
part, and are of second order (4e-6 of the force, a quarter with half the step); it says nothing."""

LEAST = 0.01
"""In SI units: smaller curves than this (m, N, J, ...) are compared with it."""


@dataclass
class Verdict:
    """What a pair came to: `right`, `wrong`, `sensitive` or `failed` (as the original does)."""

    family: str
    outcome: str
    what: str
    original: Structure
    image: Structure


# -- what is to be expected -------------------------------------------------------------------


def expected(curves: Curves, image: Image, joints: dict[str, str]) -> Curves:
    """What an image does if it moves as the original does. joints: of actions, by name."""
    result: Curves = {}
    for (kind, label), (values, unit) in curves.items():
        if kind == "position":
            values = values @ image.matrix.T + image.shift
        elif kind == "velocity":
            values = values @ image.matrix.T
        elif kind != "energy":
            sign, zero = image.opening_maps.get(joints.get(label, label), (1.0, 0.0))
            values = sign * values + (zero if kind in ("opening", "slide_opening") else 0.0)
        head, _, number = label.rpartition(" ")  # of a stretch or point of a cable, "k1 2"
        name = f"{image.names[head]} {number}" if head in image.names else label
        key = kind, label if kind == "energy" else image.names.get(label, name)
        result[key] = image.factor(unit) * values, unit
    return result


Sizes = dict[str, tuple[float, str]]
"""Of each kind of curve the largest difference, as a share of its largest value, and of what."""


def differences(curves: Curves, image_curves: Curves, image: Image) -> Sizes:
    """How far curves are from others."""
    sizes: Sizes = {}
    for (kind, label), (values, unit) in curves.items():
        if kind in image.omits:
            continue
        peaks = [np.abs(v).max() for (w, _), (v, _) in curves.items() if w == kind]
        scale, size = max(LEAST * image.factor(unit), *peaks), np.inf
        if (kind, label) in image_curves:
            skip_count = max(image.skips, kind in UNRELIABLE_STARTS)
            size = np.abs(values - image_curves[kind, label][0])[skip_count:].max() / scale
        sizes[kind] = max(sizes.get(kind, (0.0, "")), (float(size), label))
    return sizes


def sums(*parts: Sizes) -> dict[str, float]:
    """The differences of each kind of curve added up."""
    return {kind: sum(sizes[kind][0] for sizes in parts if kind in sizes) for kind in parts[0]}


# -- verdicts ---------------------------------------------------------------------------------


def nudge(structure: Structure, rng: random.Random) -> Structure:
    """All numbers a little off."""

    def change(x: float, unit: str) -> float:
        share, shift = rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0) * (unit == "m")
        return x * (1.0 + NUDGE * share) + NUDGE * shift

    return map_numbers(structure, change)


@dataclass
class Trial:
    """The pairs of one structure."""

    structure: Structure
    duration: float
    seed: str

    def verdicts(self, families: Sequence[str]) -> Iterator[Verdict]:
        """What the pair of each family came to that has one."""
        rng = random.Random(f"{self.seed} images")
        images = {name: image for name in families if (image := self._image(name, rng))}
        base = self._original()
        nudges = [replace(base, structure=nudge(self.structure, rng)) for _ in range(NUDGES)]
        runs = {name: self._run(image) for name, image in images.items()}
        simulate([base, *nudges, *runs.values()])
        if base.curves is None:
            outcome = "wrong" if IMBALANCE in base.reason else "failed"
            rest = outcome, base.reason, self.structure, self.structure
            yield from (Verdict(name, *rest) for name in runs)
            return
        growth = self._growth(base, nudges)
        for name, run in runs.items():
            result = self._verdict(base, run, images[name], growth)
            yield Verdict(name, *result, self.structure, run.structure)

    def _growth(self, base: Run, nudges: list[Run]) -> dict[str, float]:
        """What nudges change, added up; infinite where one fails."""
        if any(run.curves is None for run in nudges):
            return {kind: np.inf for kind, _ in base.curves}
        plain = Image(self.structure)
        return sums(*(differences(base.curves, run.curves, plain) for run in nudges))

    def _image(self, name: str, rng: random.Random) -> Image | None:
        if name == DELAY:
            return delay(self.structure, rng, 2 * self.duration / (INSTANTS - 1))
        return FAMILIES[name](self.structure, rng)

    def _original(self, finer: int = 1) -> Run:
        return Run(self.structure, self.duration, self.duration / STEPS / finer)

    def _run(self, image: Image, finer: int = 1) -> Run:
        """The run of an image: as long as the original after it begins, in its units."""
        second, interval = image.factor("s"), self.duration / (INSTANTS - 1)
        delay_instants = round(image.delay / interval)
        duration = (self.duration + delay_instants * interval) * second
        step = self.duration / STEPS * second / finer
        return Run(image.structure, duration, step, INSTANTS + delay_instants)

    def _verdict(
        self, base: Run, run: Run, image: Image, growth: dict[str, float]
    ) -> tuple[str, str]:
        if not growth["position"] < SENSITIVE:
            return "sensitive", f"a nudge changes positions by {growth['position']:.2g}"
        if run.curves is None:
            return "wrong", run.reason
        reference = expected(base.curves, image, self._joints())
        sizes = differences(reference, run.curves, image)
        steps = dict.fromkeys(sizes, 0.0)
        excess, text = _most_over(sizes, growth, steps)
        if excess > 1.0 and (not image.is_exact or sizes.keys() & LATCH_KINDS):
            steps = self._by_step(base, run, image)
            if image.is_exact:
                steps = {kind: size for kind, size in steps.items() if kind in LATCH_KINDS}
            excess, text = _most_over(sizes, growth, steps)
        return "right" if excess <= 1.0 else "wrong", text

    def _joints(self) -> dict[str, str]:
        actions = self.structure.get("actions", {})
        return {name: action["joint"] for name, action in actions.items() if "joint" in action}

    def _by_step(self, base: Run, run: Run, image: Image) -> dict[str, float]:
        """What half the step changes on both sides; infinite where that fails."""
        half, half_image = self._original(2), self._run(image, 2)
        simulate([half, half_image])
        if half.curves is None or half_image.curves is None:
            return {kind: np.inf for kind, _ in base.curves}
        pairs = (base, half), (run, half_image)
        return sums(*(differences(a.curves, b.curves, image) for a, b in pairs))


def _most_over(
    sizes: Sizes, growth: dict[str, float], steps: dict[str, float]
) -> tuple[float, str]:
    """The largest difference as a share of what is allowed, and in words; of what a nudge changes
    much, none."""
    worst = 0.0, "all alike"
    for kind, (size, label) in sizes.items():
        if growth[kind] < SENSITIVE:
            allowed = ROUNDING + GROWTH * growth[kind] + ORDER * steps.get(kind, 0.0)
            text = f"{kind} of {label} differs by {size:.3g} of its size, {allowed:.2g} allowed"
            worst = max(worst, (size / allowed, text))
    return worst
