"""Torque and force margins as standards ask for them: one table of factors, in one's own words.

ECSS-E-ST-33-01C (6 March 2009) 4.7.5.3, Rev.2 of 2019 may differ; NASA-STD-5017B (2022) eq. 4-1 and
AIAA S-114 (2005) at second hand. All three are the same sum,

    margin = sum of d w+ / sum of r w- - 1 >= 0,

w being virtual work per unit of travel, of what drives (w+) and what resists (w-), with factors d
and r by its class and by the evidence for it. Kinetic energy is not counted in any."""

from typing import NamedTuple

CLASSES = {
    "S": "springs", "I": "weight, inertia in an accelerated frame", "HM": "motors",
    "FR": "friction", "HY": "hysteresis", "HA": "harness and others", "HD": "adhesion",
    "TD": "inertia against a specified acceleration", "TL": "loads and the output torque",
}  # fmt: skip
"""Classes of what acts (fpm.elements.kind.ElementType.resists_as, Scene.classes), as of ECSS."""


class Standard(NamedTuple):
    """A standard for torque margins. title: its name; edition: the one that its factors are from;
    drives: factor of the moments that drive, by class (as "S" for springs), 0 where a class must
    not count; resists: factor of those that resist, by evidence ("theory", ...) and class."""

    title: str
    edition: str
    drives: dict[str, float]
    resists: dict[str, dict[str, float]]


def _by_class(numbers: str) -> dict[str, float]:
    return dict(zip(CLASSES, map(float, numbers.split()), strict=True))


def _nasa(variable: float, fixed: float, acceleration: float) -> dict[str, float]:
    factors = {"FR": variable, "HY": variable, "HA": variable, "HD": variable, "TD": acceleration}
    return {name: factors.get(name, fixed) for name in CLASSES}


#                          S   I   HM  FR HY HA HD TD   TL
_DRIVES = _by_class("          1   1   1   0  0  0  0  0    1")
STANDARDS = {
    # 2 (1.1 I + 1.2 S + 1.5 HM + 3 FR + 3 HY + 3 HA + 3 HD) + 1.25 TD + TL
    "ecss-e-st-33-01c": Standard(
        "ECSS-E-ST-33-01C", "6 March 2009; Rev.2 of 2019 may differ",
        _by_class("0.8 0.9 1   0  0  0  0  0    1"), {
            "theory": _by_class("      2.4 2.2 3   6  6  6  6  1.25 1"),
            "measurement": _by_class(" 2.4 2.2 2.4 3  3  3  6  1.25 1"),
        }),
    "nasa-std-5017b": Standard("NASA-STD-5017B", "2022, at second hand", _DRIVES, {
        "analysis": _nasa(3.00, 1.50, 1.25),
        "development test": _nasa(2.50, 1.35, 1.15),
        "acceptance test": _nasa(2.00, 1.25, 1.10),
        "spring out": _nasa(1.00, 1.00, 1.00),
    }),
    "aiaa-s-114": Standard(
        "AIAA S-114", "2005, at second hand", _DRIVES, {"analysis": _nasa(2.0, 2.0, 1.25)}
    ),
}  # fmt: skip
