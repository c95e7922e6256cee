"""Facts of campaigns as review sheets take them, made by hand: no run is made."""

from types import SimpleNamespace

from deployable.campaign.results.review import head_of, rows_of

ECSS, NASA = "ecss-e-st-33-01c", "nasa-std-5017b"


def quantity(name, lower, upper, units="1", error=0.01, **more):
    """A quantity's row; without an interval it happens in no run."""
    there = lower is not None
    return {"name": name, "long_name": f"the {name}", "units": units, "lower": lower,
            "upper": upper, "error": error, "surrogate_lower": lower, "surrogate_upper": upper,
            "simulated_lower": lower, "simulated_upper": upper, "argmin": {"k": 0.09, "f": 2.0},
            "influence": {"k": {"share": 0.7 * there, "halved": 0.07, "width_error": 0.0},
                          "f": {"share": 0.3 * there, "halved": 0.09, "width_error": 0.0}},
            "runs_with": 9 * there, "runs_without": 9 * (not there)} | more  # fmt: skip


def limit(of, kind="at_least", level=0.0, met="all", share=1.0):
    """A limit with its own verdict."""
    return {"quantity": of, "units": "1", "kind": kind, "level": level, "simulated": 0.25,
            "at": {"k": 0.1, "f": None}, "met": met, "share": share, "share_uncertainty": 0.0,
            "runs": 9}  # fmt: skip


def required(name, *limits, met=None):
    """A requirement of limits; met as the worst of them if nothing is said."""
    worst = next(
        (m for m in ("none", "some", "undecided") if m in [x["met"] for x in limits]), "all"
    )
    share = min(x["share"] for x in limits)
    return {"name": name, "met": met or worst, "share": share, "share_uncertainty": 0.0, "runs": 9,
            "limits": list(limits)}  # fmt: skip


def number(name, kind="largest", of="", subjects=(), event="", places=(), signed=False):
    """A quantity's definition: its kind, and that of its response, or an event."""
    response = None
    if of:
        response = SimpleNamespace(kind=of, subjects=subjects, least=None if signed else 0.0)
    return SimpleNamespace(name=name, kind=kind, response=response, event=event, places=places)


def of_margin(name):
    """The definition of the least margin."""
    return number(name, "smallest", "margin", signed=True)


def margin(name="m", **more):
    """What a margin is by: of a hinge `h` that is led all its way, by the standard."""
    budget = {"opening": 1.5, "margin": 0.25, "drives": 0.75, "requirement": 0.6, "rows": [
        {"part": "torsion spring h", "class_": "S", "moment": 0.9375, "factor": 0.8,
         "weighted": 0.75},
        {"part": "friction h", "class_": "FR", "moment": -0.1, "factor": 6.0, "weighted": -0.6},
    ]}  # fmt: skip
    return {"name": name, "standard": ECSS, "evidence": "theory", "openings": ["h"], "without": [],
            "apart": [], "locked": [], "starts_vary": False, "first": 0.0, "last": 1.5,
            "unit": "rad", "travel": [0.0, 1.5], "latches": [], "motors": [], "own": [],
            "weaker": [], "added": [], "springs": ["torsion spring h"],
            "drives": ["torsion spring h"], "at": {"k": 0.09, "f": 2.0},
            "budget": budget} | more  # fmt: skip


def facts_of(quantities=(), requirements=(), margins=None, **mechanism):
    """The facts; `together` as the worst of the requirements."""
    parameters = [
        {"name": "k", "description": "stiffness", "lower": 0.36, "upper": 0.44,
         "units": "N m rad-1"},
        {"name": "f", "description": "", "lower": 0.0, "upper": 2.0, "units": "N m"},
    ]  # fmt: skip
    motion = {"exchanged": 1.0, "largest": 2.0, "imbalance": 1e-4}
    mechanism = {"margins": margins or {}, "latches": [], "motion": motion} | mechanism
    found = {"quantities": list(quantities), "requirements": list(requirements),
             "parameters": parameters, "runs": {"all": 9}, "fixed": [], "duration": 2.0,
             "mechanism": mechanism}  # fmt: skip
    if requirements:
        limits = [x for one in requirements for x in one["limits"]]
        found["together"] = {k: v for k, v in required("all", *limits).items() if k != "limits"}
    return found


def experiment(numbers=()):
    """The experiment."""
    return SimpleNamespace(quantity_list=numbers, solver=SimpleNamespace(energy_tolerance=0.005))


def sheet(quantities=(), requirements=(), numbers=(), margins=None, **mechanism):
    """The rows."""
    facts = facts_of(quantities, requirements, margins, **mechanism)
    return rows_of(facts, experiment(numbers), ECSS)


def head(facts, numbers=()):
    """What stands above the rows."""
    return head_of(facts, rows_of(facts, experiment(numbers), ECSS), ECSS)


def find(rows, clause, word=""):
    """The rows of a clause whose question has a word."""
    return [row for row in rows if row["clause"] == clause and word in row["asks"]]
