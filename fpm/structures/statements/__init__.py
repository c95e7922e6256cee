"""All kinds of statements; each file beside this one has some, which importing it registers."""

from fpm.structures.statement import GROUPS, Statement
from fpm.structures.statements import connectors, joints, loads, parts, struts

__all__ = ["GROUPS", "STATEMENTS", "connectors", "joints", "loads", "parts", "struts"]

STATEMENTS: tuple[Statement, ...] = tuple(s for kinds in GROUPS.values() for s in kinds.values())
