"""Pairs of structures that must move alike: random ones, and the same once more in other words.

    python -m evidence attack --only pairs

`draw_structure` draws a structure in the language of docs/structures.md, `families` says it
otherwise (turned, mirror, later, rename_all, ...), `pairs` runs both and compares."""
