"""Keys of a structure file that are fields of elements, and elements of what the keys found."""

from dataclasses import MISSING, fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from fpm.elements.fields import Index, Word, stated
from fpm.elements.kind import Kind
from fpm.structures.keys import REQUIRED, Choice, Key, Many, Number, Opening, Reference
from fpm.structures.statement import Statement

JOINT = Opening(about="on which joint it acts")
"""The key of a field `hinge`."""


def key_of(kind: type[Kind], name: str, left_out: str = "", **changes: Any) -> Key:
    """The key of a field of a kind, with these changes.

    left_out: what it means where the key is left out, which the field does not allow by itself.
    """
    field = stated(kind)[name]
    default = {f.name: f.default for f in fields(kind)}[name]
    default = REQUIRED if default is MISSING else default
    if isinstance(field, Index) and field.of == "hinges":
        return replace(JOINT, types=field.types or JOINT.types)
    if isinstance(field, Index):
        default = None if default == -1 else default
        key: Key = Reference(default, field.about, group=field.of)
    elif isinstance(field, Word):
        key = Choice(default, field.about, options=tuple(field.values))
    else:
        default = None if default == np.inf else default
        key = Number(default, field.about, field.unit, field.least, field.above)
        if (count := field.count) > 1:
            key = Many(default, field.about, replace(key, default=REQUIRED, about=""), count, count)
    if left_out:
        key = replace(key, default=None, about=f"{key.about}; left out: {left_out}")
    return replace(key, **changes)


def keys_of(kind: type[Kind], *names: str) -> dict[str, Key]:
    """The keys of some fields of a kind."""
    return {name: key_of(kind, name) for name in names}


def element(kind: type[Kind], it: SimpleNamespace, **more: Any) -> Kind:
    """An element of a kind, from what its keys found and from `more`; None is a field's default."""
    values = {**vars(it), "hinge": getattr(it, "joint", None), **more}
    own = {f.name: values.get(f.name) for f in fields(kind)}
    own = {name: tuple(x) if isinstance(x, list) else x for name, x in own.items()}
    return kind(**{name: value for name, value in own.items() if value is not None})


def acting(kind: type[Kind]) -> Statement:
    """The statement of a kind that acts on a joint, all of whose fields are keys."""

    def build(build, it):
        build.scene.add(element(kind, it))

    build.__doc__ = kind.__doc__
    found = keys_of(kind, *stated(kind))
    keys = {"joint": found.pop("hinge"), **found}
    return Statement("actions", kind.called, keys, build)
