"""Hooks: what the time loop asks of the kinds in a scene.

A kind's kernel file has a named tuple of its arrays and, for what it does, kernels marked with
`@hook(ItsTuple)` that are named as the hooks below. Loop and kernels are compiled apart
(compiled_loop.py): at each hook the loop calls the kernels there are, in the order of the kinds. So
a new mix of known kinds compiles nothing, and a scene pays nothing for what it lacks.

Kernels say nothing of what their hook says, nor of what they all take: `part`, the arrays of their
type, whose named tuple tells shapes and units (lanes: samples side by side); `world`, the World, or
its `state`; `timing`, the StepTime (s); `row`, index of an instant; i, h, c, ..., indices of an
element, a hinge, a cable."""

import functools
import inspect
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import intrinsic

from fpm.kernels.lanes import load, store
from fpm.kernels.layout import ACCOUNTS, X
from fpm.kernels.references import calls_of, local_copy
from fpm.kernels.vectors import kernel

KERNELS: dict[tuple[type, str], Callable] = {}
"""The kernel for a named tuple and the name of a hook."""

NAMES: list[str] = []
"""Names of all hooks."""


def hook(arrays: type, name: str | None = None) -> Callable:
    """Return a decorator that compiles a function as the kernel of an element type for a hook.
    arrays: the type's NamedTuple; name: of the hook, None: the function's. ValueError for unknown
    or taken ones."""

    def register(function):
        hook_name = name or function.__name__
        if hook_name not in NAMES:
            raise ValueError(f"{hook_name} is not a hook; expected one of {', '.join(NAMES)}")
        routine = function if hasattr(function, "py_func") else kernel(function)
        kernels = {hook_name: routine}
        if hook_name == "energy_of":
            kernels |= {"sum_energies": _sum(routine), "list_energies": _list(routine)}
        for key, entry in kernels.items():
            if (arrays, key) in KERNELS:
                raise ValueError(f"{arrays.__name__} has a kernel for {key} already")
            KERNELS[arrays, key] = entry
        return routine

    return register


def _sum(energy_of: Callable) -> Callable:
    @kernel
    def total_energy(part, world):
        total = 0.0 * load(world.state, 0, X)
        for e in range(part.rows.shape[0]):
            total = total + energy_of(part, world, e)
        return total

    return total_energy


def _list(energy_of: Callable) -> Callable:
    @kernel
    def list_energies(part, world):
        for e in range(part.rows.shape[0]):
            store(part.rows, e, 0, energy_of(part, world, e))

    return list_energies


class Calls(NamedTuple):
    """The kernels of a scene's element types, compiled, as the loop calls them. starts (hooks +
    1,): first row of each hook's calls, in the order of NAMES, and the end; addresses (calls, 2):
    in memory, of the code of a kernel and of its type's arrays."""

    starts: np.ndarray
    addresses: np.ndarray


ENTRIES: dict[str, tuple[list[str], str]] = {}
"""Of each hook what is compiled for a kernel: its arguments beside `part`, the last of which is the
number of the call among those of the hook, and what it does."""


def _call_each(stub: Callable, body: str = "") -> Callable:
    """Make a hook of an empty function of (parts, ...): it calls the kernels of all types. body:
    what is compiled for a kernel, "": its call with the same arguments."""
    signature = inspect.signature(stub)
    _, *arguments = signature.parameters
    body = body or f"kernel(part, {', '.join(arguments)})"
    ENTRIES[stub.__name__] = [*arguments, "number"], body
    codegen = calls_of(len(NAMES))
    NAMES.append(stub.__name__)

    def definition(typingctx, *kinds):
        return types.void(*kinds), codegen

    functools.update_wrapper(definition, stub)
    first = inspect.Parameter("typingctx", inspect.Parameter.POSITIONAL_ONLY)
    parameters = [p.replace(kind=first.kind) for p in signature.parameters.values()]
    vars(definition)["__signature__"] = signature.replace(parameters=[first, *parameters])
    return intrinsic(definition)


def entry_of(arrays: type, name: str) -> tuple[Callable, list[str]]:
    """Return what is compiled of an element type's kernel for a hook `name`: a function of the
    type's `arrays` and of what the loop gives, and the names of that."""
    arguments, body = ENTRIES[name]
    tools = {"store": store, "local_copy": local_copy, "ACCOUNTS": ACCOUNTS}
    namespace: dict[str, Any] = {**tools, "kernel": KERNELS[arrays, name]}
    copies = "part, world = local_copy(part), local_copy(world)"
    exec(f"def {name}(part, {', '.join(arguments)}):\n    {copies}\n    {body}", namespace)
    return namespace[name], arguments


# In the order of a step. `timing` is the StepTime, `world` the World.


@_call_each
def forces(parts, world, timing):
    """Add the forces (N) and moments (N m) of all element types at timing.time to those of
    particles. parts: arrays of each element type; world: solver state; timing: step times (s)."""


@_call_each
def note_events(parts, world, timing):
    """Write the events of the step that ends now into logs (`record.note`); not at the start."""


@_call_each
def work_before(parts, world, timing):
    """Add to World.accounts the work (J) of the half step that ends now, from the present forces
    and the velocities in its middle. Not called at the start."""


@_call_each
def restrain(parts, world, timing):
    """Change summed forces and momenta before they act, as supports and damping do, and add to
    World.accounts the work (J) of the half step that begins."""


@_call_each
def prepare(parts, world, timing):
    """Kick the bodies of joints, over timing.kick (s), and apply the impulses that keep joints
    closed; types whose `solve` finds these set World.undecided instead. Rigid motors store the
    joint coordinate that they prescribe for the end of the step, rigid latches the mean rate in the
    last one."""


@_call_each
def decide(parts, world, timing):
    """Hold or free openings in this step, from the impulses that `solve` found. What changes
    anything sets World.undecided, and `solve` and `decide` are repeated; it may do so finitely
    often."""


@_call_each
def solve(parts, world, timing):
    """Find the impulses of joints in this step; called while World.undecided is set."""


@_call_each
def move(parts, world, timing):
    """Move the particles that an element type moves itself over timing.step (s)."""


@_call_each
def look_back(parts, world, timing):
    """Correct the momenta half a step before the start, once, in the first step. `reflect` has set
    them, in World.start_state, to those at the start less the change in the half step after it;
    corrected, they close the joints one step before the start too, so that the changes over the
    first instant are right. The impulses this takes are added to the joints' of this step."""


@_call_each
def work_after(parts, world, timing):
    """Add to World.accounts the work (J) of the half step after timing.time, or of the step."""


# At checks and instants, with the positions of timing.time.


SUM_COLUMN = "ACCOUNTS + world.accounts.shape[1] + number"


@functools.partial(_call_each, body=f"store(energies, row, {SUM_COLUMN}, kernel(part, world))")
def sum_energies(parts, world, energies, row):
    """Store the energy (J, lanes) of each type's elements in its column of `energies`, which the
    kernel (part, world) returns; to register `energy_of`, for one element, is simpler."""


@_call_each
def work_of_place(parts, world, energies, row):
    """Add work (J) that depends on positions only, as of weight, to recorded energies."""


@_call_each
def record(parts, world, row):
    """Write what each type records into its arrays, at instants and at each check of the energy
    balance between (`row`: a spare last one), and raise World.peaks, which fail a run above their
    limit."""


@_call_each
def record_points(parts, world, points, row, timing):
    """Overwrite recorded velocities (m/s) of points on particles that a type moves without momenta,
    in `points` (Record.points), whose rows row p to row p + p - 1 are those of the instant."""


@_call_each
def work_due(parts, world, energies, row, timing):
    """Add to recorded energies the work (J) of impulses found in the step after the instant, and
    the kinetic energy of what has no momenta, as drives do."""


@_call_each
def record_step(parts, world, row, timing):
    """Write what each type records of the step that begins at an instant (World.start_state)."""


def energy_of(part, world, e):
    """Return the energy (J, lanes) of element e (index) of a type; its kernels for `sum_energies`
    and `list_energies` are made of it. part: arrays of the type; world: solver state."""


NAMES.append("energy_of")

# When a lane fails.


@_call_each
def list_energies(parts, world):
    """After a failure, store every element's energy (J) in World.rows, to name the worst."""


@_call_each
def list_excess(parts, world):
    """After a failure, store in World.rows how large every element's watched quantity is."""
