"""Model only what a scene requires: the cost of a step with and without each element kind."""

from evidence.benchmark.clock import best
from evidence.benchmark.kernel import LANES, stable
from evidence.benchmark.scenes import bars, beam_count, linkages, runner
from evidence.rows import Row, info

GROUP = "Model only what a scene requires: four bars of 12 elements, 8 samples"

CASES = {
    "beams alone": (),
    "with gravity": ("gravity",),
    "with damping": ("damping",),
    "with constant loads on 4 particles": ("loads",),
    "with one direction held on 4 particles": ("supports",),
    "with 4 named points": ("points",),
    "with frames that differ from the particles'": ("frames",),
    "with 2 hinges": ("hinges",),
    "with 2 hinges and their springs": ("hinges", "springs"),
    "with 2 hinges, springs and contacts": ("hinges", "springs", "contacts"),
}


def kinds(steps: int, repeats: int, elements: int = 12) -> list[Row]:
    """Nanoseconds per step of the same beams with one thing more each, and of the linkage."""
    runs, counts = {}, {}
    for name, features in CASES.items():
        scenes = [bars(elements, *features)] * LANES
        runs[name] = runner(scenes, steps, stable(scenes))
        counts[name] = beam_count(scenes[0])
    linkage = "the linkage: 4 hinges, springs, contacts, supports, points"
    scenes = linkages(LANES, elements)
    runs[linkage] = runner(scenes, steps, stable(scenes))
    seconds = best(runs, repeats)
    costs = {name: 1e9 * seconds[name] / steps for name in runs}
    bare = costs["beams alone"]
    per_element = bare / beam_count(scenes[0])
    rows = [
        info("beams alone", bare, "ns per step of 8 samples",
             f"{per_element / LANES:.3g} ns per element, step and sample")
    ]  # fmt: skip
    for name, value in costs.items():
        if name != "beams alone":
            note = f"{value - bare:+.0f} ns, as much as {(value - bare) / per_element:.1f} elements"
            rows.append(info(name, value, "ns per step of 8 samples", note))
    return rows
