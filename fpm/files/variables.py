"""Variables of a run that are recorded on request only: names, units and words.

Each variable has columns along a dimension of its own; a column's label says of what it is (a
point and an axis, a bar, ...). A request names columns, as (variable, label);
`fpm.reading.columns` computes them from a run.
"""

from collections.abc import Iterable
from typing import NamedTuple

Column = tuple[str, str]
"""A variable and a label of it."""


class Variable(NamedTuple):
    """unit (UDUNITS), words, and the dimension along which its columns lie."""

    unit: str
    long_name: str
    dimension: str


VARIABLES = {
    "acceleration": Variable(
        "m s-2", "acceleration of points along global axes", "acceleration_of"
    ),
    "angular_velocity": Variable(
        "rad s-1", "angular velocity of points and bodies about global axes", "angular_velocity_of"
    ),
    "opening_rate": Variable("rad s-1", "rate of the opening of hinges", "opening_rate_of"),
    "slide_rate": Variable("m s-1", "rate of the opening of slides", "slide_rate_of"),
    "joint_moment": Variable(
        "N m", "moment on the second part of a hinge about its axis, by who acts", "joint_moment_by"
    ),
    "joint_force": Variable(
        "N", "force on the second part of a slide along its axis, by who acts", "joint_force_by"
    ),
    "joint_work": Variable("J", "work of these moments and forces so far", "joint_work_by"),
    "constraint_force": Variable(
        "N", "force by which a joint keeps its second part, along global axes",
        "constraint_force_of",
    ),
    "constraint_moment": Variable(
        "N m", "moment by which a joint keeps its second part, about its point and global axes",
        "constraint_moment_of",
    ),
    "reaction_force": Variable(
        "N", "force of a support or drive on the structure, along global axes", "reaction_force_of"
    ),
    "reaction_moment": Variable(
        "N m", "moment of a support or drive about its point and global axes",
        "reaction_moment_of",
    ),
    "section_force": Variable(
        "N", "force in a section of a bar along its own axes", "section_force_of"
    ),
    "section_moment": Variable(
        "N m", "moment in a section of a bar about its own axes", "section_moment_of"
    ),
    "stress": Variable("Pa", "largest equivalent stress (von Mises) in bars", "stress_of"),
    "clearance": Variable("m", "shortest distance of the surfaces of two bars", "clearance_of"),
}  # fmt: skip


def words(columns: Iterable[Column]) -> str:
    """Columns in words, each variable once with what it is of: for messages."""
    found: dict[str, dict[str, None]] = {}
    for variable, label in columns:
        found.setdefault(variable, {})[label] = None
    return "; ".join(
        f"{name.replace('_', ' ')} of {', '.join(labels)}" for name, labels in found.items()
    )
