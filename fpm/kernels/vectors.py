"""Three-vectors of lanes: kernels are written in them as formulas are, `c * a + cross(b, d)`.

A vector has the components x, y, z; the sum, the difference and the product with a scalar or with
lanes are operators, applied component by component."""

import operator
from collections.abc import Callable

from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic, lower_builtin, make_attribute_wrapper, models, register_model

from fpm.kernels.inlining import InlinedKernel, KernelCompiler, type_operator
from fpm.kernels.lanes import LANE, is_readable, load, read, store, where_negative, write

INLINE = {
    "error_model": "numpy",
    "boundscheck": False,
    "nogil": True,
    "_nrt": False,
    "forceinline": True,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": KernelCompiler,
}
"""Compiler options of every kernel, which is compiled into its callers only, and never called from
Python: no branches for division by zero, no GIL, no allocation.

Without allocation nothing counts references: a look into a tuple of arrays costs nothing."""


def kernel(function: Callable) -> Callable:
    """Decorator that compiles a function as a kernel, on lanes and vectors: as part of its callers
    only. Called by itself it would be slower and might round otherwise."""
    if config.DISABLE_JIT:
        return function
    options = {"nopython": True, **INLINE}
    pipeline = options.pop("pipeline_class")
    return InlinedKernel(function, pipeline_class=pipeline, targetoptions=options)


class Vector(types.Type):
    """Numba type of a vector: components x, y, z, each of the type LANE."""

    def __init__(self):
        super().__init__(name="Vector")


@register_model(Vector)
class _VectorModel(models.StructModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, [(name, LANE) for name in "xyz"])


for _name in "xyz":
    make_attribute_wrapper(Vector, _name, _name)

VECTOR = Vector()


def _components(builder, value):
    return [builder.extract_value(value, k) for k in range(3)]


def _pack(context, builder, components):
    value = ir.Constant(context.get_value_type(VECTOR), ir.Undefined)
    for k, component in enumerate(components):
        value = builder.insert_value(value, component, k)
    return value


def _register_sum(op):
    """Component by component, both sides vectors."""

    @lower_builtin(op, VECTOR, VECTOR)
    def lower(context, builder, sig, args):
        function = context.get_function(op, LANE(LANE, LANE))
        pairs = zip(*(_components(builder, arg) for arg in args), strict=True)
        return _pack(context, builder, [function(builder, pair) for pair in pairs])

    type_operator(op, [VECTOR(VECTOR, VECTOR)])


def _register_product():
    """Define the product of a number or lanes with a vector."""
    factors = LANE, types.float64, types.int64
    for factor in factors:

        @lower_builtin(operator.mul, factor, VECTOR)
        def lower(context, builder, sig, args):
            function = context.get_function(operator.mul, LANE(sig.args[0], LANE))
            values = [function(builder, (args[0], v)) for v in _components(builder, args[1])]
            return _pack(context, builder, values)

    type_operator(operator.mul, [VECTOR(factor, VECTOR) for factor in factors])


_register_sum(operator.add)
_register_sum(operator.sub)
_register_product()


@intrinsic
def vector(typingctx, x, y, z):
    """Return the vector with components x, y, z, each a Lane (numbers of samples)."""
    signature = VECTOR(LANE, LANE, LANE)
    return (signature, lambda context, builder, sig, args: _pack(context, builder, args))


@kernel
def larger(x, y):
    """Return the larger of x and y lane by lane (by sample); x where y is not a number."""
    return where_negative(x - y, y, x)


@intrinsic
def get3(typingctx, a, i, k):
    """Return the vector in fields k, k+1, k+2 of row i of an array a (rows, fields, lanes);
    typingctx: numba's, as in all that is written in LLVM."""

    def codegen(context, builder, sig, args):
        return _pack(context, builder, read(context, builder, sig, args, 3))

    return (VECTOR(a, i, k), codegen) if is_readable(a) else None


@intrinsic
def put3(typingctx, a, i, k, v):
    """Write a vector v to fields k, k+1, k+2 of row i of an array a (rows, fields, lanes)."""

    def codegen(context, builder, sig, args):
        return write(context, builder, sig, args, _components(builder, args[3]))

    return (types.void(a, i, k, v), codegen) if v == VECTOR and is_readable(a) else None


@kernel
def get6(a, i, k):
    """Return a tuple of six lanes, fields k to k+5 of row i of an array a (rows, fields, lanes)."""
    first, second, third = load(a, i, k), load(a, i, k + 1), load(a, i, k + 2)
    return first, second, third, load(a, i, k + 3), load(a, i, k + 4), load(a, i, k + 5)


@kernel
def put6(a, i, k, s):
    """Write six lanes s to fields k to k+5 of row i of an array a (rows, fields, lanes)."""
    put3(a, i, k, vector(s[0], s[1], s[2]))
    put3(a, i, k + 3, vector(s[3], s[4], s[5]))


@kernel
def add3(a, i, k, v):
    """Add a vector v to fields k, k+1, k+2 of row i of an array a (rows, fields, lanes)."""
    put3(a, i, k, get3(a, i, k) + v)


@kernel
def add_where(a, i, k, v, condition):
    """Do as `add3` in samples where `condition` (lanes) is below 0."""
    old = get3(a, i, k)
    new = old + v
    store(a, i, k, where_negative(condition, new.x, old.x))
    store(a, i, k + 1, where_negative(condition, new.y, old.y))
    store(a, i, k + 2, where_negative(condition, new.z, old.z))


@kernel
def opposite(v):
    """Return the vector -v; v: a vector with components x, y, z of lanes (numbers of samples)."""
    return vector(-v.x, -v.y, -v.z)


@kernel
def dot(a, b):
    """Scalar product (lanes) of two vectors."""
    return a.x * b.x + a.y * b.y + a.z * b.z


@kernel
def cross(a, b):
    """Return the vector product a x b of two vectors."""
    return vector(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@kernel
def times(a, b):
    """Return the product of two vectors, component by component."""
    return vector(a.x * b.x, a.y * b.y, a.z * b.z)


@kernel
def to_global(frame, v):
    """Return vector v, given along the three axes of a frame (vectors), in global components."""
    return v.x * frame[0] + (v.y * frame[1] + v.z * frame[2])


@kernel
def to_local(frame, v):
    """Return the components of a global vector v along the three axes of a frame (vectors)."""
    return vector(dot(frame[0], v), dot(frame[1], v), dot(frame[2], v))


@kernel
def symmetric(s, v):
    """Product of a symmetric matrix s (xx, yy, zz, xy, xz, yz) and a vector v."""
    return vector(
        s[0] * v.x + s[3] * v.y + s[4] * v.z,
        s[3] * v.x + s[1] * v.y + s[5] * v.z,
        s[4] * v.x + s[5] * v.y + s[2] * v.z,
    )


@kernel
def invert(s):
    """Inverse of a symmetric 3 by 3 matrix, by cofactors; both (xx, yy, zz, xy, xz, yz)."""
    xx = s[1] * s[2] - s[5] * s[5]
    xy = s[4] * s[5] - s[3] * s[2]
    xz = s[3] * s[5] - s[4] * s[1]
    r = 1.0 / (s[0] * xx + s[3] * xy + s[4] * xz)
    return (
        r * xx,
        r * (s[0] * s[2] - s[4] * s[4]),
        r * (s[0] * s[1] - s[3] * s[3]),
        r * xy,
        r * xz,
        r * (s[3] * s[4] - s[0] * s[5]),
    )
