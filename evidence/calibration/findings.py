"""What the calibration's scans say: its checks, and how sharp the fit is."""

from functools import cache

import numpy as np

from evidence.calibration.plan import MESHES
from evidence.calibration.scans import CLOSE, DURATION, PAPER, Numbers, Scan
from evidence.linkage.rigid import RigidBennett
from evidence.linkage.runs import default
from evidence.rows import Row, close_to

COINCIDE = 0.05
UNITS = {"BD": "m", "vBz": "m/s"}
PAPER_SOURCE = "paper, section 4"
RIGID_SOURCE = "rigid linkage, one degree of freedom (evidence/linkage/rigid.py)"
STUDY_SOURCE = "this study"


def near_to(name, value, reference, share, source, note="") -> Row:
    """A value that may miss its reference by a share of it."""
    return close_to(name, value, reference, share * abs(reference), source, note)


@cache
def rigid_closings(stiffness: float) -> np.ndarray:
    """Closing times (s) of the rigid linkage with this K_F (N/rad) in the time of the paper."""
    model, times = RigidBennett(spring_stiffness=stiffness), np.linspace(0.0, DURATION, 11)
    run = model.simulate(default("start"), times, tolerance=1e-7)
    return run["closings"]


def checks(scans: list[Scan]) -> list[Row]:
    """The rows of summary.json. `scans` as planned, the default reading first."""
    main, k = scans[0], default("K_F")
    numbers = main.numbers_at(k)
    best = min((n for n in main.numbers if 4.8 <= n.K_F <= 6), key=lambda n: n.misfit)
    name = "K_F of the scene against the least misfit of the default reading, 4.8 to 6 N/rad"
    return [
        *_against_the_paper(numbers),
        close_to(name, k, best.K_F, 0.1, STUDY_SOURCE),
        *_against_finer(scans, numbers),
        *_against_rigid(main, numbers),
    ]


def _against_the_paper(numbers: Numbers) -> list[Row]:
    """What the paper tells, against the scene's K_F."""
    counts = [len(c) for c in numbers.closures]
    rows = [
        near_to(f"{n}: largest difference of the bounds ({UNITS[n]})", numbers.largest[n], PAPER[n],
                CLOSE, PAPER_SOURCE, f"at {numbers.times[n]:.4f} s")
        for n in PAPER
    ]  # fmt: skip
    rows += [
        close_to(f"closures in 1 s, {word} of the samples", value, 2, 0, PAPER_SOURCE)
        for word, value in (("fewest", min(counts)), ("most", max(counts)))
    ]
    return rows + [
        close_to(f"{n}: largest difference before the first closure, share of the curve's range",
               numbers.first_width[n] / numbers.span[n], 0, COINCIDE, PAPER_SOURCE,
               f"{numbers.first_width[n]:.3g} {UNITS[n]}; the paper: the bounds coincide")
        for n in PAPER
    ]  # fmt: skip


def _against_finer(scans: list[Scan], numbers: Numbers) -> list[Row]:
    """The default mesh and step against finer ones, where those were scanned."""
    rows, by_label = [], {scan.reading.label: scan for scan in scans}
    for label, tolerance in ((f"{max(MESHES)} elements a link", 0.1), ("step × 0.5", 0.05)):
        if label in by_label:
            finer = by_label[label].numbers_at(numbers.K_F)
            rows += [
                near_to(f"{n}: largest difference, default against {label} ({UNITS[n]})",
                        numbers.largest[n], finer.largest[n], tolerance, STUDY_SOURCE)
                for n in PAPER
            ]  # fmt: skip
    return rows


def _against_rigid(main: Scan, numbers: Numbers) -> list[Row]:
    """Closing times against the rigid linkage's and its law of scaling."""
    rigid, first = rigid_closings(default("K_F")), numbers.closure(0).mean()
    products = np.array([n.closure(0).mean() * np.sqrt(n.K_F) for n in main.numbers])
    departure = np.abs(products / (first * np.sqrt(numbers.K_F)) - 1).max()
    return [
        near_to("first closure, mean of the samples (s)", first, rigid[0], 0.02, RIGID_SOURCE,
                "the real links bend, the reference's do not"),
        close_to("first closure times √K_F, largest relative departure over the scan", departure, 0,
               0.02, "rigid linkage: time scales with 1/√K_F until contact"),
    ]  # fmt: skip


def findings(scans: list[Scan]) -> dict:
    """How sharp the fit is, and what explains it; numbers for summary.json and table.md."""
    main, k = scans[0], default("K_F")
    numbers = main.numbers_at(k)
    stiffnesses = [n.K_F for n in main.numbers if all(len(c) > 1 for c in n.closures)]
    neighbours = [n for n in main.numbers if abs(n.K_F - k) <= 0.1 + 1e-9]
    is_at_second = main.fits & main.at_second_closure
    facts = {
        "K_F of the scene (N/rad)": k,
        "misfit there": numbers.misfit,
        "least misfit": main.best.misfit,
        "K_F of the least misfit (N/rad)": main.best.K_F,
        "K_F that fits (N/rad)": spans(main.K_F, main.fits),
        "the same, largest differences at the second closure (N/rad)": spans(
            main.K_F, is_at_second
        ),
        "least K_F with the second closure of all samples within 1 s (N/rad)": min(
            stiffnesses, default=None
        ),
        "closings of the rigid linkage (s)": rigid_closings(k).tolist(),
    }
    for index, word in enumerate(("first", "second")):
        times = numbers.closure(index)
        facts[f"{word} closure of the samples (s)"] = [float(times.min()), float(times.max())]
    for name in PAPER:
        values = [n.largest[name] for n in neighbours]
        key = f"{name} for K_F within 0.1 N/rad of the scene's ({UNITS[name]})"
        facts[key] = [min(values), max(values)]
    return facts


def spans(values: np.ndarray, mask: np.ndarray) -> list[list[float]]:
    """Runs of neighbouring values at which `mask` holds, each as [first, last]."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return [
        [float(values[i]), float(values[j - 1])]
        for i, j in zip(edges[::2], edges[1::2], strict=True)
    ]
