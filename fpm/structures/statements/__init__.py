"""All kinds of statements; each file beside this one has some, which importing it registers."""

from fpm.elements import KINDS
from fpm.elements.openings.opening import Connector
from fpm.structures.statement import GROUPS, Statement, whole
from fpm.structures.statements import connectors, joints, loads, parts

__all__ = ["GROUPS", "STATEMENTS", "connectors", "joints", "loads", "parts"]

for _kind in KINDS:  # elements on a joint whose keys are their fields
    if issubclass(_kind, Connector) and _kind.noun not in GROUPS["actions"] | GROUPS["joints"]:
        whole(_kind)

STATEMENTS: tuple[Statement, ...] = tuple(s for kinds in GROUPS.values() for s in kinds.values())
