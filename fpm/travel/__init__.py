"""Travel: an opening is led slowly from one value to another, and what acts is told apart.

At every position the opening is held, and the rest lies in balance: all joints closed, and strain,
springs, loops, cables, weight and loads in equilibrium (fpm/assembly), without what only resists,
as friction. The way from one position to the next is that of the balance itself,

    H t + G'p = 0,   G t = e

e being one for the opening that is led and zero for all other conditions; t, the motion of all
particles per unit of the opening, starts the next position. Each element's virtual work w = F·t is
what it gives (w > 0) or takes per unit of the way, at a rate that vanishes: by its own kernels,
with friction sliding the way that its joint goes. Kinetic energy does not enter, nor what holds:
motors that prescribe the opening, releases, and latches.
"""

from fpm.travel.components import STRAIN, classes_of_kinds, parts_of, reeled, springs_of
from fpm.travel.travel import Travel, lead

__all__ = ["STRAIN", "Travel", "classes_of_kinds", "lead", "parts_of", "reeled", "springs_of"]
