"""Hooks: what the time loop asks of the kinds in a scene.

A kind's kernel file has a named tuple of its arrays and, for what it does, kernels marked with
`@hook(ItsTuple)` that are named as the hooks below. Loop and kernels are compiled apart
(compiled_loop.py): at each hook the loop calls the kernels there are, in the order of the kinds. So
a new mix of known kinds compiles nothing, and a scene pays nothing for what it lacks."""

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
    """Return a decorator that compiles a function as a kernel and registers it as what an element
    type does at one point of each step (a hook, as "forces"). arrays: the NamedTuple of the type's
    arrays, the kernel's first argument; name: of the hook, None: the function's name. The
    decorator raises ValueError for unknown or taken hooks."""

    def register(function):
        hook_name = name or function.__name__
        if hook_name not in NAMES:
            raise ValueError(f"{hook_name} is no hook; expected one of {', '.join(NAMES)}")
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
    """Return what is compiled of the kernel that an element type has for a hook: a function of the
    type's arrays and what the loop gives, whose names are returned as well. arrays: NamedTuple of
    the type; name: of the hook."""
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
    """Write the events of the step that ends now into logs, by `events.note`; not called at the
    start. parts: arrays of each element type; world: solver state; timing: step times (s)."""


@_call_each
def work_before(parts, world, timing):
    """Add to World.accounts the work (J) of the half step that ends now, from the present forces
    and the velocities in the middle of the half step. Not called at the start. parts: arrays of
    each element type; world: solver state (World); timing: times of this step (s)."""


@_call_each
def restrain(parts, world, timing):
    """Change summed forces and momenta of particles before they act, as supports and damping do,
    and add to World.accounts the work (J) of the half step that begins. parts: arrays of each
    element type; world: solver state (World); timing: times of this step (s)."""


@_call_each
def prepare(parts, world, timing):
    """Kick the bodies of joints, and get all ready for `solve`. The impulses of all forces on these
    bodies, over timing.kick (s), are added to their momenta, and those that keep the joints closed
    as well; element types whose `solve` finds these set World.undecided instead. Rigid motors store
    the joint coordinate that they prescribe for the end of the step, rigid latches the mean rate of
    theirs in the last one. parts: arrays of each element type; world: solver state (World),
    changed; timing: times of this step (s)."""


@_call_each
def decide(parts, world, timing):
    """Hold or free openings in this step (as rigid latches and rigid friction do), from the
    impulses that `solve` found. An element that changes anything sets World.undecided, and `solve`
    and `decide` are repeated; it may change only finitely often per step. parts: arrays of each
    element type; world: solver state (World); timing: times of this step (s)."""


@_call_each
def solve(parts, world, timing):
    """Find the impulses of joints and other constraints in this step; called while World.undecided
    is set. parts: arrays of each element type; world: solver state; timing: step times (s)."""


@_call_each
def move(parts, world, timing):
    """Move the particles that an element type moves itself over timing.step (s). parts: arrays of
    each element type; world: solver state (World), changed; timing: times of this step (s)."""


@_call_each
def look_back(parts, world, timing):
    """Correct the momenta half a step before the start, once, in the first step. `reflect` has just
    set them, in World.start_state, to those at the start less the change in the half step after it;
    corrected, they close the joints one step before the start too, so that the changes over the
    first instant are right. Adds the impulses this takes to the joints' of this step. parts: arrays
    of each element type; world: solver state (World), changed; timing: times of this step (s)."""


@_call_each
def work_after(parts, world, timing):
    """Add to World.accounts the work (J) of the half step after timing.time, or of the whole step.
    parts: arrays of each element type; world: solver state (World); timing: step times (s)."""


# At checks and instants, with the positions of timing.time.


SUM_COLUMN = "ACCOUNTS + world.accounts.shape[1] + number"


@functools.partial(_call_each, body=f"store(energies, row, {SUM_COLUMN}, kernel(part, world))")
def sum_energies(parts, world, energies, row):
    """Store the energy (J, lanes) of all elements of each type in its column of row `row` of
    `energies`, the recorded ones. The kernel that a type registers takes (part, world) and returns
    that sum; to register `energy_of`, for one element, is simpler. parts: arrays of each element
    type; world: solver state (World)."""


@_call_each
def work_of_place(parts, world, energies, row):
    """Add work (J) that depends on positions only, as of weight, to recorded energies. parts:
    arrays of each type; world: solver state; energies: Record.energies; row: instant's index."""


@_call_each
def record(parts, world, row):
    """Write what each element type records into its arrays, at recorded instants and at each check
    of the energy balance between them, and raise World.peaks, the largest values so far of watched
    quantities, which fail a run above their limit. parts: arrays of each element type; world:
    solver state (World); row: index of the instant in these arrays, of a spare last row between."""


@_call_each
def record_points(parts, world, points, row, timing):
    """Overwrite the recorded velocities (m/s) of named points on particles that an element type
    moves without momenta, as drives do. parts: arrays of each element type; world: solver state;
    points ((instants + 1) p, 6, lanes): Record.points, of p named points, changed; row: index of
    the recorded instant, whose point n is points[row p + n]; timing: times of this step (s)."""


@_call_each
def work_due(parts, world, energies, row, timing):
    """Add to recorded energies the work (J), up to the instant, of impulses found in the step after
    it, and the kinetic energy of what has no momenta, as drives do. parts: arrays of each element
    type; world: solver state (World); energies: Record.energies; row: index of the instant; timing:
    times of this step (s)."""


@_call_each
def record_step(parts, world, row, timing):
    """Write what each type records of the step that begins at an instant into its arrays. parts:
    arrays of each element type; world: solver state, World.start_state that at the step's start;
    row: index of the recorded instant; timing: times of this step (s)."""


def energy_of(part, world, e):
    """Return the energy (J, lanes) of element e (index) of a type; its kernels for `sum_energies`
    and `list_energies` are made of it. part: arrays of the type; world: solver state."""


NAMES.append("energy_of")

# When a lane fails.


@_call_each
def list_energies(parts, world):
    """After a failure, store every element's energy (J) in its row of World.rows, to name the
    worst. parts: arrays of each element type; world: solver state (World)."""


@_call_each
def list_excess(parts, world):
    """After a failure, store in World.rows, in the rows of each type, how large every element's
    watched quantity is. parts: arrays of each element type; world: solver state (World)."""
