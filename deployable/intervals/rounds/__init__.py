"""Which runs come next: where bounds are decided, and where they may be wider."""

from .places import Places, deciding_places
from .seek import seek_points

__all__ = ["Places", "deciding_places", "seek_points"]
