"""The time loop: cost per element, step and sample, of a batch and of one sample."""

import fpm
from evidence.benchmark.clock import best
from evidence.benchmark.scenes import beam_count, linkages, runner
from evidence.rows import Row, at_least, at_most, info

GROUP = "Kernel: the paper's linkage"
UNIT = "ns per element, step and sample"


def stable(scenes: list[fpm.Scene]) -> float:
    """A step (s) that suits all the scenes, found from the first."""
    return 0.85 * fpm.find_stable_step(scenes[0]).step


def cost(steps: int, repeats: int, samples: int = 32, meshes=(8, 12, 16, 32)) -> list[Row]:
    """A batch and a single sample on several meshes, and their ratio."""
    runs, units = {}, {}
    for elements in meshes:
        scenes = linkages(samples, elements)
        step = stable(scenes)
        for name, group in ((f"batch {elements}", scenes), (f"single {elements}", scenes[:1])):
            runs[name] = runner(group, steps, step)
            units[name] = beam_count(scenes[0]) * steps * len(group)
    runs["set-up"] = runner(linkages(samples, meshes[0]), 1, stable(linkages(1, meshes[0])))
    seconds = best(runs, repeats)
    costs = {name: 1e9 * seconds[name] / units[name] for name in units}
    setup = 1e3 * seconds["set-up"] / samples
    rows = [info("setting up a run and handing it back", setup, "ms per sample")]
    for elements in meshes:
        batch, single = costs[f"batch {elements}"], costs[f"single {elements}"]
        label = f"{elements} elements a link" + (" (default)" if elements == 12 else "")
        rows.append(at_most(f"batch of {samples}, {label}", batch, 6.0, unit=UNIT))
        note = "one sample fills one lane of eight, and costs as much as eight"
        name, unit = f"single sample, {label}", "ns per element and step"
        rows.append(at_most(name, single, 40.0, note=note, unit=unit))
        name = f"lanes against one sample, {label}"
        rows.append(at_least(name, single / batch, 5.0, unit="x"))
    return rows
