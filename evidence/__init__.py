"""What the program is worth: its verification, the studies of its limits, and its benchmark.

    python -m evidence NAME --output results/NAME      one of those in registry.py

Each study is a folder whose study.py has PARTS (what it measures, by name) and `report` (what
follows from the parts: rows, tables). All leave the same summary.json and table.md.
"""
