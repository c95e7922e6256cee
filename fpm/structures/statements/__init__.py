"""All kinds of statements; each file beside this one has some, which importing it registers."""

from fpm.structures.statement import GROUPS, Statement
from fpm.structures.statements import connectors, joints, loads, parts, struts

__all__ = ["GROUPS", "STATEMENTS", "connectors", "joints", "loads", "parts", "struts"]

STATEMENTS: tuple[Statement, ...] = tuple(
    statement for kinds in GROUPS.values() for statement in kinds.values()
)
