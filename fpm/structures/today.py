"""What the mechanics cannot carry yet, refused by name. This file goes when they can."""

from fpm.structures.problems import Problems
from fpm.structures.reading import Table

LATER = frozenset(
    [("joints", kind) for kind in ("spherical", "fixed", "prismatic", "universal")]
    + [("actions", kind) for kind in ("motor", "release")]
)
"""Groups and types that are planned."""

LATER_KEYS = frozenset(["bodies", "assemble"])
"""Keys of a file that are planned."""


def refuse_later(table: Table, problems: Problems) -> None:
    """Note the keys of a file that are planned."""
    for key in LATER_KEYS & table.entries.keys():
        problems.say(table.lines[key], f"{key}: comes later; allowed: a file without it")


def check_pair(build, it) -> None:
    """A joint of more than two parts needs joints that are solved together."""
    if len(it.parts) > 2:
        names = [part.name for part in it.parts]
        build.refuse("parts", names, "two parts; three members on a pin come later")


def check_free(build, it, particles) -> None:
    """Two joints at one point of a part need to be solved together."""
    for particle, part in zip(particles, it.parts, strict=True):
        others = [name for name in build.joined[particle] if name != it.name]
        if others and not build.scene.fixed[particle].all():
            build.refuse(
                "at", f"a point of {part.name} where joint {others[0]} is already",
                "one joint at a point of a part; several come later",
            )  # fmt: skip
