"""Quasi-static sweep of a joint opening over its travel, with the virtual work of every component.

At every position the opening is held, the rest is in static balance: all joints closed, and strain,
springs, loops, cables, weight and loads in equilibrium (fpm/assembly), without components that only
resist, as friction. The motion from one position to the next is that of the balance itself,

    H t + G'p = 0,   G t = e

e being one for the prescribed opening and zero for all other conditions; t, the motion of all
particles per unit of the opening, predicts the next position. The virtual work w = F·t of each
element, per unit of the opening at a vanishing rate, is actuating (w > 0) or resistive (w < 0);
it comes from the element's own kernels, with friction that slips as its joint goes. Kinetic energy
does not enter, nor do elements that hold: motors that prescribe the opening, releases, latches."""

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
