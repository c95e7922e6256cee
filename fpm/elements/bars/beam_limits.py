"""How far the elements may be from small strains: what linear beam theory can bear."""

from fpm.elements.kind import Watch


def _bend_failure(values: dict[str, float]) -> tuple[str, str]:
    return (
        f"an element is bent or twisted by {values['bend']:.2g} rad, too much for linear theory",
        "refine the mesh: the bend and twist of an element fall with its length",
    )


def _strain_failure(values: dict[str, float]) -> tuple[str, str]:
    return (
        f"the surface of an element is strained by {values['strain']:.2g}, which no beam bears",
        "no mesh or step helps where links are bent to a radius below their own height or "
        "stretched by half: stiffen their material, or soften what bends them",
    )


BEND = Watch("bend", 0.25, False, _bend_failure)
"""Largest sine of the angle between an element's chord and its ends, and of its twist. Whipping
links whose elements bend by so much have errors of some percent (docs/extremes.md); beyond that the
energy still balances, on a wrong curve. A finer mesh bends less."""

STRAIN = Watch("strain", 0.5, False, _strain_failure)
"""Largest strain at the surface of an element: its stretch, and half its height over the radius to
which it is bent. At 0.5 that radius is the height: no beam, whatever the mesh. (A bar curved to
such a radius is 8 % stiffer than a straight one: Winkler's theory of curved bars.)"""
