"""The time loop as plain Python, with other operations on lanes than the compiled ones."""

import sys
import types
from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module


class Vector:
    """Three lanes, for `fpm.kernels.vectors.vector`."""

    __array_ufunc__ = None
    __slots__ = ("x", "y", "z")

    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z

    def __add__(self, right):
        return Vector(self.x + right.x, self.y + right.y, self.z + right.z)

    def __sub__(self, right):
        return Vector(self.x - right.x, self.y - right.y, self.z - right.z)

    def __rmul__(self, factor):
        return Vector(factor * self.x, factor * self.y, factor * self.z)


def run_as_python(operations: Mapping[str, Callable], in_part: Callable) -> None:
    """Make fpm run its kernels as Python, with `operations` in the place of those of their names.

    in_part(name, function): what each kernel that the loop calls is replaced by. RuntimeError
    if numba compiles."""
    import numba

    from fpm.kernels import compiled_loop, hooks, lanes, sources, vectors
    from fpm.kernels import run as loop

    for path in (sources.PACKAGE / "elements").rglob("*_kernels.py"):
        import_module(".".join(path.relative_to(sources.PACKAGE.parent).with_suffix("").parts))
    if not numba.config.DISABLE_JIT:
        raise RuntimeError("set NUMBA_DISABLE_JIT=1 before this module is used")
    for key, kernel in hooks.KERNELS.items():
        hooks.KERNELS[key] = in_part(_name_of(kernel), kernel)
    substitutes = {id(compiled_loop.prepare_call): lambda _, *rest: partial(loop.run, *rest)}
    for name, operation in {**operations, **_find_rows(**operations)}.items():
        substitutes[id(getattr(vectors if hasattr(vectors, name) else lanes, name))] = operation
    for name, value in list(vars(loop).items()):
        is_part = isinstance(value, types.FunctionType) and value is not loop.run
        if is_part and id(value) not in substitutes:
            setattr(loop, name, in_part(_name_of(value), value))
    for module in [m for name, m in sys.modules.items() if name.startswith("fpm.")]:
        for name, value in list(vars(module).items()):
            if id(value) in substitutes:
                setattr(module, name, substitutes[id(value)])
    for name in hooks.ENTRIES:
        setattr(hooks, name, _call_each(hooks, name))


def _find_rows(load: Callable, store: Callable, vector: Callable, **_) -> dict[str, Callable]:
    """What reads and writes vectors, made of the operations on lanes."""

    def get3(a, i, k):
        return vector(load(a, i, k), load(a, i, k + 1), load(a, i, k + 2))

    def put3(a, i, k, v):
        store(a, i, k, v.x)
        store(a, i, k + 1, v.y)
        store(a, i, k + 2, v.z)

    return {"get3": get3, "put3": put3}


def _call_each(hooks: types.ModuleType, name: str) -> Callable:
    """What a hook does, as Python: `parts` are the arrays of each element type."""
    arguments, body = hooks.ENTRIES[name]
    namespace = {**vars(hooks)}
    source = f"def entry(kernel, part, {', '.join(arguments)}):\n    {body}"
    exec(source, namespace)

    def call_each(parts, *rest):
        kernels = ((hooks.KERNELS.get((type(part), name)), part) for part in parts)
        for k, (kernel, part) in enumerate(pair for pair in kernels if pair[0]):
            namespace["entry"](kernel, part, *rest, k)

    return call_each


def _name_of(kernel: Callable) -> str:
    """A kernel as a part of the loop: its module and its name."""
    module = kernel.__module__.rsplit(".", 1)[-1].removesuffix("_kernels")
    return f"{module}.{kernel.__name__}"
