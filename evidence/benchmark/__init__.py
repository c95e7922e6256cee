"""What the solver and the workflow cost, beside their targets and beside Exudyn.

Every figure is the best of several, and figures that are compared are measured in turns in one run,
so that a machine that is busy with other things spoils them least. docs/benchmark.md explains them.
"""
