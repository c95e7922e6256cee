"""All kinds of statements; each file beside this one has some, which importing it registers."""

from fpm.structures.statement import GROUPS, Statement
from fpm.structures.statements import acting, joints, moved, parts, struts

__all__ = ["GROUPS", "STATEMENTS", "acting", "joints", "moved", "parts", "struts"]

STATEMENTS: tuple[Statement, ...] = tuple(
    statement for kinds in GROUPS.values() for statement in kinds.values()
)
