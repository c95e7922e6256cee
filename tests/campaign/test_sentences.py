"""All sentences that summaries and pages can say, one example of each, in `sentences.md`, which
`python tests/campaign/test_sentences.py` writes."""

from __future__ import annotations

import copy
import re
from functools import cache
from pathlib import Path

import pytest
from jinja2 import nodes
from sheets import sheet
from test_review_sheet import ROWS as OF_SHEET

from deployable.campaign.results.templates import _escape, doubt_texts, environment
from fpm.files.seals import unseal

GOLDEN = Path(__file__).with_name("sentences.md")

K = {"name": "k", "units": "N m rad-1", "description": "from the hub to the spring",
     "lower": 0.0, "nominal": 0.4, "upper": 0.8}  # fmt: skip
C = {"name": "c", "units": "1", "description": "", "lower": 1.0, "nominal": 1.5, "upper": 3.0}
ANGLE = K | {"name": "angle", "units": "degree", "lower": 0.3}
TIME = {
    "name": "t_open", "quantity": "t_open", "long_name": "time of the first event", "units": "s",
    "words": "time at which the latch `root` latches", "event": "the latch `root` latches",
    "lower": 3.8, "upper": 9.0, "simulated_lower": 3.8, "simulated_upper": 8.9,
    "surrogate_lower": 3.8, "surrogate_upper": 9.0,
    "error": 0.3, "censored_at": None, "predicted_ends": [], "runs_with": 20, "runs_without": 0,
    "happens": 0.9, "happens_uncertainty": 0.01, "may_be_endless": False, "late_parts": [],
    "influence": {
        "k": {"share": 0.7, "fixed": 1.0, "halved": 3.0, "width_error": 0.1},
        "c": {"share": 0.3, "fixed": 4.0, "halved": 5.1, "width_error": 0.2},
    },
}  # fmt: skip
SPEED = TIME | {
    "name": "v", "quantity": "v", "long_name": "speed of end at t_open", "units": "m s-1",
    "words": "speed of the point `end` when the latch `root` latches", "lower": 0.1, "upper": 0.69,
    "error": 0.02,
}  # fmt: skip
CURVE = {
    "name": "root", "long_name": "opening of hinge root", "words": "opening of the hinge `root`",
    "units": "rad", "grade": "small",
    "largest_difference": 1.1, "time_of_largest_difference": 3.8, "trusted": None,
    "error_at_largest_difference": 0.05,
    "shares": {"k": 0.6, "c": 0.4}, "lower": 0.4, "largest_growth_quarter": 0.02,
    "published": None, "largest_error": 0.06, "time_of_largest_error": 4.0,
}  # fmt: skip
LIMIT = {
    "quantity": "t_open", "units": "s", "words": TIME["words"], "event": TIME["event"],
    "kind": "at_most", "level": 9.0, "margin": 0.8, "error": 0.1, "kept": True, "at": {"k": 0.4},
    "ran": True, "simulated": 8.2, "requirement": "in_time", "met": "some", "share": 0.9,
    "fit_error": 0.2, "share_uncertainty": 0.01, "runs": 125, "halved": {"k": 0.95, "c": None},
}  # fmt: skip
HAPPENS = LIMIT | {"kind": "happens", "level": True, "margin": None, "kept": False}
SOFT = LIMIT | {"quantity": "v", "units": "m s-1", "words": SPEED["words"], "level": 0.8}
ABSENT = SOFT | {"margin": None}
PART = {"name": "in_time", "met": "some", "share": 0.9, "share_uncertainty": 0.01, "runs": 125}
HALF = {"share": 0.99, "share_uncertainty": 0.001, "gain": 0.09, "gain_uncertainty": 0.002}
TOGETHER = PART | {
    "max_interval_scale": 0.56, "unsampled": False, "failures": 68, "fails": LIMIT, "whole": False,
    "halved": {"k": HALF, "c": HALF | {"gain": 0.001}},
}  # fmt: skip
CHOICE = {
    "parameters": [{"name": "k", "units": "N m rad-1", "lower": 0.3, "upper": 0.8, "value": 0.5,
                    "decides": True, "safe": None, "safest": None}],
    "kept": True, "safe": True, "limits": [LIMIT], "tried": [],
    "goals": [SPEED | {"sense": "minimise", "end": "upper", "value": 0.67, "error": 0.03,
                       "fit_error": 0.03, "at": {"k": 0.5}, "ran": True, "simulated": 0.66}],
}  # fmt: skip
WORST = {"test": "swing", "response": "phi", "units": "rad", "time": 0.16, "bands": 1.3,
         "residual": 0.004}  # fmt: skip
MEASURED = {
    "refuted": False, "least": 0.7, "attained": 0.9, "left": 1e-4, "hull": 3e-4, "worst": WORST,
    "singles": [], "disjoint": [], "checks": [], "limits": [], "runs": 136,
    "trade_offs": [{"names": ["k", "c"], "slope": 2.0, "correlation": 0.99}],
    "parameters": [{"name": "c", "units": "1", "before": [0, 1], "after": [0, 1], "best": 0.5,
                    "seen": "none"}],
    "next": [WORST | {"spread": 0.02, "bands": None}, WORST | {"spread": 0.02}],
}  # fmt: skip
FACTS = {
    "campaign": "first", "scene": "array", "about": "Rigid panels that springs unfold",
    "duration": 12.0, "parameters": [K, C], "fixed": [], "failures": [], "overlap": 0.06,
    "runs": {"design": 37, "checks": 10, "further": 88, "choice": 158, "measured": 0, "failed": 0,
             "all": 293},
    "design": {"method": "smolyak", "order": [3, 3], "nodes": 33, "held_out": 4, "runs": 37},
    "bounds": "attained range of the model that predicts left-out runs best",
    "time_step": 0.005, "finest_step": 0.005, "assembly_energy": 0.0,
    "closures": [{"time": 5.1, "contact": "latch a"}, {"time": 5.2, "contact": "latch b"}],
    "responses": [CURVE], "quantities": [TIME, SPEED],
    "requirements": [PART | {"limits": [LIMIT]}], "together": TOGETHER,
}  # fmt: skip
FREE = {key: value for key, value in FACTS.items() if key not in ("requirements", "together")}


def facts(base=FACTS, **changes):
    """Facts with changes; those of a dict replace single keys of it."""
    made = copy.deepcopy(base)
    for key, value in changes.items():
        made[key] = made[key] | value if isinstance(value, dict) and key in made else value
    return made


def together(**changes):
    return facts(together=changes)


def chosen(base=None, **changes):
    return facts(choice=CHOICE | changes, **(base or {}))


def measured(**changes):
    return facts(measured=MEASURED | changes)


def rows(*quantities, base=FREE, **changes):
    return facts(base, quantities=list(quantities), **changes)


def curve(**changes):
    return CURVE | changes


def parameter(**changes):
    return CHOICE["parameters"][0] | changes


LARGE = curve(grade="large", error_at_largest_difference=0.5, largest_error=0.5,
              trusted={"difference": 0.9, "error": 0.05, "time": 3.0},
              times_of_large_error={"from": 3.7, "to": 4.2, "throughout": True})  # fmt: skip
AROUND = LARGE | {"times_of_large_error": {"from": 0.1, "to": 4.2, "throughout": False}}
EXACT = TIME | {"error": 1e-6}
NEVER = TIME | {"lower": None, "runs_with": 0, "runs_without": 20}
UNFINISHED = {"name": "root", "duration": 12.0, "at": {"k": 0.4}}
REACHED = {"name": "root", "units": "rad", "value": 1.2, "level": 1.57, "time": 2.0, "moves": True}
ROWS = [{"state": "met", "clause": "4.7", "of": "v"}, {"state": "not analysed", "clause": "4.8",
                                                       "of": ""}]  # fmt: skip
IDLE = PART | {"limits": [LIMIT | {"idle": "is negative in all runs"}]}
FLOOR = PART | {"limits": [LIMIT | {"kind": "at_least", "idle": "is never below 0"}]}
SINGLES = [{"name": "swing", "refuted": True, "attained": 2.0},
           {"name": "drop", "refuted": False, "attained": 0.8}]  # fmt: skip
LATE = curve(time_of_largest_error=6.0)

CASES = {
    "What it answers": [
        ("headline", together(met="all", share=1.0, share_uncertainty=0.0)),
        ("headline", together(met="all", share=1.0, share_uncertainty=0.0, runs=1)),
        ("headline", facts(requirements=[IDLE], together={"met": "all", "share_uncertainty": 0.0})),
        ("headline", together(met="undecided", share=1.0, share_uncertainty=0.0)),
        ("headline", together(met="undecided", share=1.0, share_uncertainty=0.03, runs=1)),
        ("headline", together(met="none", share=0.0, share_uncertainty=0.0)),
        ("headline", together(met="none", share=0.0, share_uncertainty=0.1)),
        ("headline", together(met="some", share=0.0, share_uncertainty=1.0)),
        ("headline", facts(requirements=[
            PART | {"limits": [HAPPENS]}, PART | {"name": "gentle", "limits": [ABSENT]},
            PART | {"limits": [LIMIT | {"margin": None, "kept": False}]},
            PART | {"met": "none", "limits": [LIMIT | {"margin": -0.5}]},
            PART | {"name": "hard", "limits": [ABSENT | {"level": 0.5, "kept": False}]},
        ])),
        ("headline", facts(requirements=[PART | {"met": "undecided", "limits": [LIMIT]}])),
        ("headline", facts(requirements=[
            PART | {"name": name, "limits": [ABSENT]} for name in ("soft", "gentle")
        ])),
        ("headline", facts(together={"share": 0.8}, requirements=[
            PART | {"limits": [ABSENT | {"event": "the stop `end` is hit"}]}
        ])),
        ("headline", facts(together={"share": 0.995, "share_uncertainty": 0.02}, requirements=[
            PART | {"name": name, "met": "undecided", "limits": [LIMIT]} for name in "ab"
        ])),
        ("headline", facts(review={"rows": ROWS})),
        ("headline", FREE),
        ("headline", rows()),
        ("given", FACTS),
        ("given", facts(duration=12000.0)),
        ("given", facts(unvaried=["mass"])),
        ("given", facts(parameters=[C], about="", closures=[])),
        ("given", facts(parameters=[K, C, ANGLE, K | {"name": "last"}])),
        ("given", facts(parameters=[], runs={**dict.fromkeys(FACTS["runs"], 0), "all": 1})),
        ("failures", facts(failures=[{"reason": "its energy does not balance", "at": {"k": 0.4}}])),
        ("failures", chosen({"failures": [
            {"reason": "it is unstable", "at": {"k": x}} for x in (0.1, 0.2, 0.3, 0.4)
        ]})),
        ("failures", FACTS),
    ],
    "Does it meet the requirements?": [
        ("required", FREE),
        ("required", rows(TIME | {"runs_without": 3})),
        ("required", rows(NEVER)),
        ("required", FACTS),
        ("required", facts(together={"failures": 1, "whole": True},
                           runs={"choice": 1, "checks": 0})),
        ("required", together(failures=0, max_interval_scale=0, fails=LIMIT | {"simulated": None})),
        *(("required", together(fails=LIMIT | {"simulated": None, "kept": False, "event": event}))
          for event in (LIMIT["event"], "the opening of the hinge `root` reaches 1.5 rad",
                        "there is a largest speed of `end`")),
        ("required", facts(requirements=[IDLE], together={"fails": None})),
        ("required", together(fails=LIMIT | {"kept": True, "simulated": 9.1}, failures=0)),
        ("required", together(fails=LIMIT | {"ran": False})),
        ("required", together(fails=LIMIT | {"ran": False, "error": None}, whole=True)),
        ("required", together(fails=None, max_interval_scale=1, failures=0)),
        ("required", together(unsampled=True)),
        ("required", facts(runs=dict.fromkeys(("choice", "checks", "further"), 0))),
        ("idle", facts(requirements=[FLOOR])),
    ],
    "When does it happen, and how hard?": [
        ("ranges", rows(TIME | {"censored_at": 12.0, "upper": 12.0})),
        *(("ranges", rows(row, row | {"runs_without": 2}))
          for row in (TIME | {"constant": True, "upper": 3.8}, TIME, SPEED, SPEED | {
              "predicted_ends": ["upper"], "words": "largest speed"
          }, TIME | {"predicted_ends": ["lower", "upper"]})),
        ("ranges", rows(TIME, SPEED, TIME, TIME, SPEED)),
        ("ranges", rows(NEVER)),
        ("happens", FACTS),
        ("happens", rows(NEVER)),
        ("happens", rows(TIME | {"runs_with": 1}, closures=[])),
        ("closing", facts(closures=[{"time": 1.0, "contact": name} for name in "ABCD"]), 2),
        ("closing", facts(closures=[{"time": t, "contact": "A"} for t in (1.0, 1.1, 1.2)]), 2),
        ("closing", facts(closures=[{"time": t, "contact": "A"} for t in (1.0, 1.1, 1.2)]), 3),
        ("closing", FACTS, 1),
        ("differences", facts(responses=[curve(constant=True), LARGE])),
        ("differences", facts(responses=[CURVE, curve(error_at_largest_difference=None), CURVE])),
        ("occurrences", [TIME | {"runs_without": 2}, SPEED | {"runs_without": 2}]),
        ("occurrences", [TIME | {"runs_without": 2, "censored_at": 12.0}, SPEED | {
            "runs_without": 2
        }]),
        *(("early", TIME | {"censored_at": 12.0} | error)
          for error in ({"error": None}, {"errors": {"whole": 0.5}})),
        ("occurrences", [TIME | {"runs_without": 2}]),
        ("occurrences", [TIME | {"runs_without": 2}, SPEED | {"runs_without": 2, "happens": 0.5}]),
        *(("occurrences", [TIME | {"runs_without": 3, "unfinished": UNFINISHED | counts}], [K],
           shown) for counts, shown in (({"late": 1, "stuck": 2}, [CURVE]),
                                        ({"late": 2, "stuck": 0, "at": {}}, []),
                                        ({"late": 3, "stuck": 0, "at": {}}, []),
                                        ({"late": 0, "stuck": 1, "at": {}}, []))),
        ("occurrences", [NEVER]),
        ("occurrences", [NEVER | {"reached": REACHED}]),
        ("occurrences", [NEVER | {"reached": REACHED | {"moves": False}}]),
        ("occurrences", [NEVER | {"reached": REACHED | {"value": 1.57}}]),
    ],
    "Which tolerance is worth tightening?": [
        ("tolerance", facts(FREE, quantities=[], responses=[curve(constant=True)],
                            parameters=[K, C, ANGLE])),
        ("tolerance", together(met="all")),
        ("tolerance", together(max_interval_scale=0)),
        ("tolerance", rows(TIME | {"constant": True}, parameters=[K])),
        ("tolerance", facts(FREE, parameters=[ANGLE])),
        ("tolerance", chosen()),
        ("tolerance", facts(together={"halved": {"k": HALF, "c": HALF}}, requirements=[
            PART | {"limits": [LIMIT | {"halved": {"k": 0.95, "c": 0.1}}]}
        ])),
        ("tolerance", facts(requirements=[PART | {"limits": [LIMIT | {"halved": {"k": -0.1}}]}])),
        *(("close_by", facts(requirements=[
            PART | {"name": name, "limits": [LIMIT | {"halved": {"k": 0.05}}]} for name in names
        ]), "k") for names in (["in_time"], ["in_time", "gentle"])),
        ("tolerance", together(halved={n: HALF | {"gain": 0} for n in "kc"})),
        ("tolerance", together(met="undecided")),
        ("tolerance", rows(TIME, TIME | {"name": "late", "influence": {
            "k": TIME["influence"]["c"], "c": TIME["influence"]["k"]
        }})),
        ("open_by", facts(requirements=[PART | {"met": "undecided", "limits": [
            LIMIT | {"met": "undecided", "margin": 0.9}
        ]}]), "k"),
        ("tolerance", facts(requirements=[PART | {"limits": [LIMIT]}, PART | {
            "name": "opens", "met": "undecided", "limits": [HAPPENS | {"met": "undecided"}]
        }])),
        ("tolerance", rows(TIME | {"influence": {
            "k": TIME["influence"]["k"] | {"halved": None}, "c": TIME["influence"]["c"]
        }, "censored_at": 9.0})),
        ("tolerance", rows(TIME | {"influence": dict.fromkeys("kc", TIME["influence"]["k"])})),
        ("tolerance", rows(TIME | {"influence": {
            n: x | {"width_error": 9} for n, x in TIME["influence"].items()
        }})),
        ("tolerance", rows(responses=[CURVE, curve(shares={"k": 0.5, "c": 0.5})])),
        ("tolerance", rows(responses=[curve(shares={})])),
        ("tolerance", rows(TIME | {"influence": {}}, responses=[curve(shares={})])),
    ],
    "Which nominal value is best?": [
        ("choice", FACTS),
        ("choice", chosen()),
        ("choice", chosen(safe=False)),
        *(("choice", chosen(
            limits=[LIMIT | {"error": 0.7}], goals=CHOICE["goals"] * 2, tried=[
                {"values": [k], "goals": [0.6, 0.67 + k / 10], "margins": [k], "kept": kept}
                for k in (0.4, 0.5, 0.6)
            ],
        )) for kept in (True, False)),
        ("choice", chosen({"requirements": [PART | {"limits": [LIMIT]}] * 2})),
        ("choice", chosen({"together": {"met": "none"}}, limits=[LIMIT | {"error": 0.7}])),
        ("choice", chosen({"requirements": [], "quantities": [SPEED | {"runs_without": 3}]},
                          goals=[CHOICE["goals"][0] | {"value": 0.5}])),
        ("choice", chosen(limits=[], goals=[CHOICE["goals"][0] | {"end": "width"}])),
        ("choice", chosen(goals=[CHOICE["goals"][0] | {"end": "lower", "sense": "maximise"}],
                          limits=[LIMIT | {"margin": 1e-4, "error": None}])),
        ("choice", chosen(parameters=[parameter(decides=False)])),
        ("choice", chosen(parameters=[parameter(decides=False), parameter(name="c")])),
        ("choice", chosen(parameters=[parameter(value=0.3, safe=[0.4, 0.6], safest=0.5)])),
        ("choice", chosen(parameters=[parameter(safe=[0.4, 0.6], safest=0.5),
                                      parameter(name="c", value=0.8)])),
        ("choice", chosen(goals=[{"quantity": "v", "units": "1", "end": "upper",
                                  "sense": "minimise", "value": 2.0, "error": 0.0}])),
        ("choice", chosen(limits=[HAPPENS | {"kept": True, "margin": 3.0, "error": 1.0}])),
        ("choice", chosen(kept=False)),
        ("choice", chosen({"together": {"met": "all"}}, kept=False)),
        ("choice", chosen(kept=False, parameters=[parameter(decides=False)])),
        ("choice", chosen(kept=False, parameters=[
            parameter(name=name, decides=False) for name in ("k", "c", "angle")
        ])),
    ],
    "What do the tests say?": [
        ("tested", FACTS),
        ("tested", measured()),
        ("tested", measured(left=2e-4, least=0.9)),
        ("tested", measured(attained=1.2)),
        ("tested", measured(refuted=True, singles=SINGLES, disjoint=[["a", "b"], ["a", "c"]])),
        ("tested", measured(refuted=True)),
        ("tested", measured(checks=[
            {"name": f"drop{i}", "inside": inside, "attained": 1.0, "least": 1.3, "worst": WORST}
            for i, inside in enumerate((True, None, False))
        ])),
        ("next_tests", MEASURED["next"]),
        ("traded", MEASURED["trade_offs"][0]),
        *(("narrowed_limit", LIMIT | {"met": met}) for met in ("all", "some", "undecided")),
        ("test_runs", MEASURED),
    ],
    "How far can this be trusted?": [
        ("reliance", FACTS),
        ("reliance", facts(responses=[LARGE, curve(grade="unknown", name="v")])),
        *(("reliance", facts(responses=[one])) for one in (AROUND, LARGE | {
            "times_of_large_error": {"from": 4.0, "to": 4.0, "throughout": True}
        })),
        ("reliance", facts(FREE, responses=[LARGE])),
        ("reliance", facts(FREE, unvaried=["mass", "k"])),
        ("reliance", facts(requirements=[PART | {"met": "undecided", "limits": [LIMIT]}],
                           late_peaks=["t_open"])),
        ("reliance", rows(TIME | {"predicted_ends": ["upper"], "errors": {"whole": 0.2}},
                          SPEED | {"doubt": "`K` is free"}, accuracy={"unmet": ["t_open"]},
                          late_peaks=["most", "top"],
                          responses=[curve(grade="unknown"), LARGE | {"name": "lift"}])),
        ("trust", FACTS),
        ("trust", together(share=0.995, share_uncertainty=0.02)),
        ("trust", facts(unseen_from=0.64)),
        ("trust", together(met="all", share=1.0, share_uncertainty=0.0)),
        ("trust", together(met="none", share=0.0, share_uncertainty=0.0)),
        ("missed", together(met="all", share_uncertainty=0.0), False),
        ("trust", facts(responses=[curve(grade="unknown")])),
        ("trust", facts(responses=[LARGE | {"undivided_from": 3.9}] * 2)),
        ("trust", together(met="all", share=1.0, share_uncertainty=0.0, failures=0)
         | {"requirements": [PART | {"limits": [HAPPENS]}], "quantities": [EXACT, SPEED]}),
        ("trust", facts(responses=[LARGE | {"along": {
            "first": 0.0, "last": 90.0, "duration": 12.0, "unit": "degree"
        }}])),
        ("soft", facts(contacts=["K_C"], responses=[LATE])),
        ("soft", facts(closures=[])),
        ("soft", facts(contacts=["K_C"], late_peaks=["t_open"], fixed=[
            {"name": "K_C", "value": 1e4, "units": "N rad-1", "description": "contact stiffness"}
        ])),
        ("remedy", facts(accuracy={}), CURVE),
        ("remedy", facts(parameters=[K] * 9), CURVE),
        ("remedy", FACTS, LATE),
        ("remedy", facts(bounds="enclosed range of a polynomial"), CURVE),
        ("remedy", facts(bounds="least and largest sample"), CURVE),
        *(("bounds", kind) for kind in ("enclosed range of a polynomial", FACTS["bounds"],
                                        "least and largest sample")),
        ("scan", {"drawn_runs": 120, "share_outside": 0.02, "share_outside_95": 0.04}),
        ("growth", [CURVE, curve(name="lift"), curve(name="tip")]),
        ("made", FACTS),
        ("made", facts(finest_step=0.001, assembly_energy=2.0, design={
            "order": [0], "held_out": 0
        })),
        *(("accuracy", facts(
            accuracy={"met": True, "rounds": 1, "runs": 300, "seconds": 0.3, "mesh": {},
                      "reason": "", "unmet": [], "others": 2}, responses=rows_of))
          for rows_of in ([CURVE], [LARGE, AROUND])),
        *(("accuracy", facts(
            quantities=[TIME | {"errors": {"share": 0.0501, "target": 0.05}},
                        SPEED | {"errors": {"share": share, "target": 0.05}}],
            accuracy={"met": False, "rounds": 4, "runs": 300, "seconds": 30.0, "mesh": {"N": 4},
                      "reason": "The rounds ended as no more runs are allowed",
                      "unmet": ["t_open", "v"], "others": others}))
          for share, others in ((0.3, 0), (None, 1), (0.3, 2))),
    ],
    "Cells of tables": [
        ("worst", LIMIT), ("worst", LIMIT | {"kind": "at_least", "margin": -0.5, "error": None}),
        ("worst", HAPPENS), ("room", HAPPENS), ("room", LIMIT),
        ("limit", {"quantity": "v", "kind": "happens", "level": False}), ("limit", HAPPENS),
        ("limit", LIMIT | {"kind": "at_least"}), ("limit", SOFT),
        ("margin", LIMIT), ("margin", LIMIT | {"margin": 0.0}),
        ("margin", LIMIT | {"error": None}), ("margin", LIMIT | {"margin": 0.05}),
        ("margin", LIMIT | {"is_partial": True}), ("margin", HAPPENS | {"kept": True}),
        ("part", PART), ("part", PART | {"met": "undecided"}),
        ("part", PART | {"limits": [SOFT | {"level": 12.0}]}, [SPEED]),
        *(("verdict", PART | {"limits": [LIMIT], "met": met}, [TIME])
          for met in ("all", "undecided", "some", "none")),
        ("verdict", PART | {"limits": [SOFT | {"level": 12.0}]}, [SPEED]),
        ("simulated", LIMIT, [TIME], 4), ("simulated", LIMIT | {"failed": True}, [TIME], 4),
        ("simulated", LIMIT | {"simulated": None}, [TIME], 4),
        ("simulated", LIMIT | {"simulated": None, "ran": False}, [TIME], 4),
        ("simulated", HAPPENS | {"kept": True}, [TIME], 4),
        ("simulated", HAPPENS | {"simulated": None, "ran": False}, [NEVER], 4),
        *(("seen", {"seen": seen}) for seen in ("both", "lower", "upper", "none")),
        ("ends", NEVER), ("ends", TIME), ("ends", TIME | {"censored_at": 12.0}),
        ("ends", TIME | {"error": 1.0}), ("ends", TIME | {"errors": {"whole": 1.0}}),
        ("ends", TIME | {"late_parts": ["t_a", "t_b"]}),
        ("ends", TIME | {"predicted_ends": ["lower", "upper"]}),
        ("budget", {"surrogate": 0.1, "whole": 0.2, "share": 0.1, "target": 0.05}),
        ("budget", {"surrogate": 0.1, "whole": 0.2, "share": 0.1}), ("budget", {"share": None}),
        ("where", LIMIT, [K]), ("where", HAPPENS | {"kept": True}, [K]),
        ("where", LIMIT | {"lower_at": {"k": 0.1}}, [K]),
        *(("reliable", row) for row in (curve(grade="none"), curve(grade="unknown"), CURVE, LARGE,
                                        curve(error_at_largest_difference=1e-9),
                                        LARGE | {"error_at_largest_difference": 0.01},
                                        LARGE | {"error_at_largest_difference": None},
                                        LARGE | {"trusted": None})),
        *(("error", CURVE | {"size": 1.5}, value) for value in (0.1, 1e-16, None)),
        *(("error", row, 0.0) for row in (TIME, NEVER)),
        *(("goal_name", CHOICE["goals"][0] | {"end": end}) for end in ("upper", "lower", "width")),
        ("halved_margin", LIMIT, "k"), ("halved_margin", LIMIT, "c"),
        ("halved_margin", LIMIT | {"margin": 0.94}, "k"),
        *(("halved_share", TOGETHER | part, name) for name in "kc" for part in (
            {}, {"halved": {"k": HALF | {"share": 0.995, "share_uncertainty": 0.02}}}
        )),
        ("unshown", [TIME | {"sense": "minimise", "end": "upper"}, CHOICE["goals"][0]]),
        ("goal_value", CHOICE["goals"][0]), ("limit_value", HAPPENS | {"kept": True}),
        ("limit_value", LIMIT), ("short_limit", LIMIT), ("short_limit", HAPPENS),
        ("short_limit", HAPPENS | {"level": False}), ("cut", TOGETHER),
        ("cut", {"max_interval_scale": 0.00123}),
        ("narrowed", TIME, "k", "halved"), ("narrowed", TIME | {"constant": True}, "k", "fixed"),
        ("narrowed", TIME | {"surrogate_upper": 4.75}, "k", "fixed"),
        ("narrowed", TIME | {"influence": {"k": {"fixed": None, "width_error": 0.1}}}, "k",
         "fixed"),
        ("sheet_head", FACTS, ROWS, ["met", "not met", "not analysed"], "ECSS"),
        ("sheet_head", facts(parameters=[]), ROWS[1:], ["met"], "ECSS"),
    ],
}  # fmt: skip


DECIDING = LIMIT | {"case": "heavy", "close": ["soft", "hot"], "where": "k = 0.4 N m/rad",
                    "requirement": "in_time"}  # fmt: skip
OF_CASES = {"name": "in_time", "met": "all", "failing": [], "undecided": [],
            "cases": ["heavy", "soft", "hot"], "worst": DECIDING}  # fmt: skip
COMPARED = {"cases": ["heavy", "soft", "hot", "cold"], "worst": DECIDING,
            "together": {"met": "all", "failing": [], "undecided": [], "free": []}}  # fmt: skip
BOTH_ENDS = TIME | {"lower_error": 0.1, "lower_cases": ["hot"], "upper_error": None,
                    "upper_cases": ["soft"], "censored_cases": [], "never": [],
                    "by_case": [None, TIME]}  # fmt: skip
WIDE = {"units": "m", "lower": 0.1, "upper": 0.4, "width": 0.2, "time": 0.3}


def compared(**changes):
    return facts(COMPARED, together=changes)


CASES_OF_CASES = {
    "What the cases of a campaign answer together": [
        ("headline", facts(COMPARED, together=None)),
        ("headline", compared()), ("headline", compared(free=["hot", "soft", "cold"])),
        ("headline", compared(met="some", failing=["heavy"], undecided=["hot"], free=["cold"])),
        ("headline", compared(met="none", failing=["heavy", "hot"])),
        ("headline", compared(met="undecided", undecided=["heavy"])),
        ("headline", compared(met="undecided", undecided=["heavy", "hot"])),
        ("trust", facts(COMPARED, runs=125)), ("trust", compared(met="some") | {"runs": 125}),
        ("overall", compared()), ("overall", compared(met="some", failing=["heavy"])),
        ("overall", compared(met="none", failing=["heavy", "hot"])),
        ("in_cases", {"text": "Trust them.", "cases": ["heavy", "hot"]}),
        ("in_cases", {"text": "Trust them.", "cases": COMPARED["cases"]}),
        ("next_case", MEASURED["next"][0] | {"case": "heavy"}),
    ],
    "Cells of tables of cases": [
        ("of_cases", ["hot", "cold"]), ("of_cases", COMPARED["cases"]),
        ("verdict", OF_CASES), ("verdict", OF_CASES | {"cases": ["heavy"]}),
        ("verdict", OF_CASES | {"met": "some", "failing": ["heavy"], "undecided": ["hot"]}),
        *((name, row) for name in ("deciding", "where", "run_there") for row in
          (DECIDING, DECIDING | HAPPENS | {"kept": True, "close": []})),
        ("deciding", DECIDING | {"close": []}),
        *(("run_there", DECIDING | {"simulated": None, "ran": ran}) for ran in (True, False)),
        *(("limit_cell", row) for row in (None, LIMIT, LIMIT | {"met": "all", "share": 1.0})),
        ("quantity_cell", None), ("quantity_cell", NEVER), ("quantity_cell", TIME),
        ("quantity_cell", TIME | {"runs_without": 2, "predicted_ends": ["upper"], "error": None}),
        ("curve_cell", None), ("curve_cell", WIDE),
        *(("curve_cell", WIDE | {"lower_change": 0.01, "upper_change": 0.02} | at)
          for at in ({"instants": 9.0}, {"interpolation_error": 0.003})),
        ("whole", NEVER), ("whole", BOTH_ENDS),
        ("whole", BOTH_ENDS | {"never": ["hot"]}),
        ("whole", BOTH_ENDS | {"censored_cases": ["hot"]}),
    ],
}  # fmt: skip


@cache
def collect():
    """Texts by heading, and the lines of branches that none of them went through."""
    texts, missed = {}, []
    for template, cases in (("sentences.jinja", CASES), ("cases.jinja", CASES_OF_CASES)):
        made, lines = collect_from(template, cases)
        texts |= made
        missed += lines
    return texts, missed


def collect_from(template, cases):
    """The same of the macros of one template."""
    env, passed = environment(), set()
    source, path, _ = env.loader.get_source(env, template)
    tree = env.parse(source, template, path)
    branches = {}

    def mark(line, *value):
        branches[len(branches)] = line
        number = nodes.Const(len(branches) - 1)
        return nodes.Call(nodes.Name("passed", "load"), [number, *value], [], None, None)

    for node in tree.find_all((nodes.If, nodes.For)):
        node.body.insert(0, nodes.Output([mark(node.body[0].lineno)]))
        if node.else_:
            node.else_.insert(0, nodes.Output([mark(node.else_[0].lineno)]))
    for node in tree.find_all(nodes.CondExpr):
        node.expr1 = mark(node.lineno, node.expr1)
        node.expr2 = mark(node.lineno, node.expr2) if node.expr2 else None
    env.globals["passed"] = lambda number, value="": (passed.add(number), value)[1]
    macros = env.from_string(tree).make_module({"facts": COMPARED})
    texts, lines = {}, source.splitlines()
    for heading, calls in cases.items():
        texts[heading] = [say(macros, name, *map(_escape, given)) for name, *given in calls]
    missed = sorted(branches[i] for i in branches.keys() - passed)
    return texts, [f"{template}, {n}: {lines[n - 1][:150]}" for n in missed]


def say(macros, name, *given):
    """What a macro says."""
    return getattr(macros, name)(*given)


def sentences_of(text):
    """The sentences of a text."""
    return re.split(r"(?<=[.!?])\s+(?=[A-Z`“\d])", " ".join(text.split()))


def test_every_branch_says_something():
    _, missed = collect()
    assert not missed, "\n".join(missed)


def words_in(sentence):
    """How many words a sentence has without what stands in brackets, which users write."""
    return len(re.sub(r"\([^()]*\)", "", sentence).split())


def write():
    """The text of `sentences.md`: each sentence once, whatever numbers and names are in it."""
    known, lines = set(), ["# What summaries and pages say", ""]
    cells = [row[key] for stated, *_ in OF_SHEET.values() for row in sheet(*stated)
             for key in ("asks", "analysed", "value", "verdict", "nearest")]  # fmt: skip
    for heading, texts in (collect()[0] | {"Cells of the review sheet": cells}).items():
        lines += [f"## {heading}", ""]
        for sentence in (s for text in texts for s in sentences_of(text) if s):
            shape = re.sub(r"[\d.−⁻⁰-⁹×]+|`[^`]*`", "#", sentence)
            lines += [f"- {sentence}"] * (shape not in known)
            known.add(shape)
        lines.append("")
    lines += [f"- {text}." for text in doubt_texts({"a": "`K` is free", "b": "`K` is free"})]
    return "\n".join(lines) + "\n"


def test_the_sentences_are_those_that_were_read():
    """Whoever changes a template writes the file anew and reads it as an editor, whole."""
    assert write() == GOLDEN.read_text(encoding="utf-8")


def test_sentences_are_short():
    sentences = [
        sentence
        for heading, texts in collect()[0].items() if not heading.startswith("Cells of tables")
        for text in texts for sentence in sentences_of(text)
    ]  # fmt: skip
    check_lengths(sentences)


def check_lengths(sentences):
    assert not [sentence for sentence in sentences if words_in(sentence) > 25]
    assert sum(map(words_in, sentences)) / len(sentences) <= 15


def check_summary(path):
    """The same of a summary, without its headings, tables and configs."""
    text = re.sub(r"```.*?```", "", unseal(path).decode().replace("**", ""), flags=re.DOTALL)
    lines = [line for line in text.splitlines() if line and line[0] not in "|#"]
    sentences = [sentence for line in lines for sentence in sentences_of(line)]
    assert len(sentences) > 4
    check_lengths(sentences)


def test_sentences_of_summaries_are_short(rich, finished):
    for folder in (rich[0], finished):
        check_summary(folder / "summary.md")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["latch", "deploys", "small", "paper"])
def test_sentences_of_shipped_summaries_are_short(shipped, name):
    check_summary(shipped(name)[0] / "summary.md")


if __name__ == "__main__":
    GOLDEN.write_text(write(), encoding="utf-8")
