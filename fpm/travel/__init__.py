"""Quasi-static sweep of a joint opening over its travel, with the virtual work of every component.

Theory: docs/mechanics.md, "Quasi-static motion of an opening". The virtual work w = F·t of each
element, per unit of the opening at a vanishing rate, is actuating (w > 0) or resistive (w < 0).
Kinetic energy does not enter, nor do elements that hold."""

from fpm.travel.components import (
    STRAIN,
    classes_of_kinds,
    component_classes,
    find_reels,
    springs_of,
)
from fpm.travel.path import Path
from fpm.travel.travel import Travel, sweep

__all__ = ["STRAIN", "Path", "Travel", "classes_of_kinds", "component_classes", "find_reels",
           "springs_of", "sweep"]  # fmt: skip
