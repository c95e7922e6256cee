"""Rates of openings at whole steps."""

from fpm.kernels.vectors import kernel


@kernel
def rate(step, change, before):
    """Rate (rad/s) at the end of a step from the changes over it and over the one before.

    Of second order, and explicit. Changes are zero before the start: what the damping of a start in
    motion lacks there, the step after makes up for.
    """
    return (1.0 / step) * (1.5 * change - 0.5 * before)
