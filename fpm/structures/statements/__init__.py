"""All kinds of statements, in the order in which a scene is built of them.

A statement may refer to those of groups further up. To add a kind, write a file like those beside
this one and put its class into the list.
"""

from fpm.structures.statement import Statement
from fpm.structures.statements import acting, bars, held, joints, moved, recorded, sections

STATEMENTS: tuple[type[Statement], ...] = (
    sections.Material,
    sections.Square,
    sections.Rectangle,
    sections.Circle,
    sections.Tube,
    sections.General,
    bars.Bar,
    held.Support,
    joints.Revolute,
    acting.TorsionSpring,
    acting.Contact,
    moved.Curve,
    moved.Load,
    moved.Drive,
    moved.Motion,
    recorded.Recorded,
)

GROUPS: dict[str, dict[str, type[Statement]]] = {}
for _statement in STATEMENTS:
    GROUPS.setdefault(_statement.group, {})[_statement.type] = _statement
