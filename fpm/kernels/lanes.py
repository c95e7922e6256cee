"""SIMD lanes as a numba type: one value holds the same quantity of several samples.

A kernel written with lanes reads like scalar code, yet every operation is one LLVM vector
instruction over all samples of the batch. This does not lean on the auto-vectoriser, which gives up
silently (on index wrap-around, on alias checks, on large loop bodies).

A register holds eight ``float64`` or sixteen ``float32`` (512 bits; LLVM splits it on narrower
machines). The lanes never mix, so a sample's numbers do not depend on which samples run beside it.
Multiply-add may be fused (``contract``); nothing else is relaxed: one machine, the same bits.

Arrays hold lanes along the last, contiguous axis: ``(rows, fields, WIDTH)``; ``load(a, i, k)``
reads the lanes ``a[i, k, :]``."""

import operator

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, lower_builtin, models, register_model

from fpm.kernels.inlining import type_operator

WIDTH = 8
"""Samples that share one register in double precision."""

CONTRACT = ("contract",)
WORD = ir.IntType(64)


def width(dtype: np.dtype) -> int:
    """Return the number of samples that are simulated side by side in a SIMD register (lanes) for
    the number type `dtype`: 8 for float64, 16 for float32."""
    return WIDTH * 8 // np.dtype(dtype).itemsize


class Lane(types.Type):
    """Numba type of one number of several samples side by side (lanes), in a 512-bit register.
    scalar: numba's type of each."""

    def __init__(self, scalar):
        self.scalar = scalar
        self.count = 512 // scalar.bitwidth
        super().__init__(name=f"Lane({scalar} x {self.count})")


@register_model(Lane)
class _LaneModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        element = ir.DoubleType() if fe_type.scalar == types.float64 else ir.FloatType()
        super().__init__(dmm, fe_type, ir.VectorType(element, fe_type.count))


LANES = {scalar: Lane(scalar) for scalar in (types.float64, types.float32)}


def _splat(context, builder, value, scalar_type, lane):
    """Repeat a scalar in every lane."""
    value = context.cast(builder, value, scalar_type, lane.scalar)
    vector_type = context.get_value_type(lane)
    blank = ir.Constant(vector_type, ir.Undefined)
    start = builder.insert_element(blank, value, ir.Constant(ir.IntType(32), 0))
    index = ir.IntType(32)
    mask = ir.Constant(ir.VectorType(index, lane.count), [index(0)] * lane.count)
    return builder.shuffle_vector(start, start, mask)


def _as_lane(context, builder, value, value_type, lane):
    if isinstance(value_type, Lane):
        return value
    return _splat(context, builder, value, value_type, lane)


_BINARY = {
    operator.add: "fadd",
    operator.sub: "fsub",
    operator.mul: "fmul",
    operator.truediv: "fdiv",
}
_SCALARS = (types.float64, types.int64)


def _register_binary(op, instruction):
    cases = []
    for lane in LANES.values():
        pairs = [(lane, lane)] + [(lane, s) for s in _SCALARS] + [(s, lane) for s in _SCALARS]
        for lhs, rhs in pairs:
            cases.append(lane(lhs, rhs))

            @lower_builtin(op, lhs, rhs)
            def lower(context, builder, sig, args, lane=lane):
                x = _as_lane(context, builder, args[0], sig.args[0], lane)
                y = _as_lane(context, builder, args[1], sig.args[1], lane)
                return getattr(builder, instruction)(x, y, flags=CONTRACT)

    numbers = (types.float64, types.int64)[: 1 if op is operator.truediv else 2]
    type_operator(op, [n(n, n) for n in numbers] + cases)


for _op, _instruction in _BINARY.items():
    _register_binary(_op, _instruction)


def _register_negative():
    for lane in LANES.values():

        @lower_builtin(operator.neg, lane)
        def lower(context, builder, sig, args):
            return builder.fneg(args[0])

    type_operator(operator.neg, [lane(lane) for lane in LANES.values()])


_register_negative()


def lane_of(array):
    """Return the lane type into which rows of `array` (numba's type) are read; None if unfit."""
    if not (isinstance(array, types.Array) and array.ndim == 3 and array.layout == "C"):
        return None
    return LANES[array.dtype]


def _addresses(context, builder, sig, args, count):
    """Addresses of the lanes in row args[1] of the C-contiguous array args[0] (no index
    wrap-around), in `count` fields from args[2] on."""
    row, field = (context.cast(builder, args[k], sig.args[k], types.intp) for k in (1, 2))
    place = context.data_model_manager[sig.args[0]].get_field_position
    fields = builder.extract_value(args[0], [place("shape"), 1])
    lane = lane_of(sig.args[0])
    index = builder.add(builder.mul(row, fields), field)
    index = builder.mul(index, WORD(lane.count))
    address = builder.gep(builder.extract_value(args[0], place("data")), [index])
    first = builder.bitcast(address, context.get_value_type(lane).as_pointer())
    return [first, *(builder.gep(first, [WORD(k)]) for k in range(1, count))]


def read(context, builder, sig, args, count=1):
    """Return the lanes in `count` fields of an array, as `load` reads one; arguments as numba gives
    them to what writes the code of a function of (array, row, field, ...)."""
    align = lane_of(sig.args[0]).scalar.bitwidth // 8
    addresses = _addresses(context, builder, sig, args, count)
    return [builder.load(address, align=align) for address in addresses]


def write(context, builder, sig, args, values):
    """Write lanes `values` to as many fields of an array, as `store` does one; the others: `read`.
    Returns what a function without a result gives."""
    align = lane_of(sig.args[0]).scalar.bitwidth // 8
    addresses = _addresses(context, builder, sig, args, len(values))
    for address, value in zip(addresses, values, strict=True):
        builder.store(value, address, align=align)
    return context.get_dummy_value()


@intrinsic
def load(typingctx, array, row, field):
    """Return the lanes (numbers of samples side by side) ``array[row, field, :]`` of a C-contiguous
    array (rows, fields, width). typingctx: numba's."""
    lane = lane_of(array)
    return lane and (lane(array, row, field), lambda *context: read(*context)[0])


@intrinsic
def store(typingctx, array, row, field, value):
    """Write `value`, lanes (numbers of samples side by side) or one number for all, to ``array[row,
    field, :]``. typingctx: numba's."""

    def codegen(context, builder, sig, args):
        vector = _as_lane(context, builder, args[3], sig.args[3], lane)
        return write(context, builder, sig, args, [vector])

    lane = lane_of(array)
    return lane and (types.void(array, row, field, value), codegen)


def _unary(name):
    @intrinsic
    def operation(typingctx, x):
        if not isinstance(x, Lane):
            return None

        def codegen(context, builder, sig, args):
            vector = context.get_value_type(sig.args[0])
            suffix = f"v{sig.args[0].count}f{sig.args[0].scalar.bitwidth}"
            full_name, kind = f"llvm.{name}.{suffix}", ir.FunctionType(vector, [vector])
            function = builder.module.globals.get(full_name)
            function = function or ir.Function(builder.module, kind, full_name)
            return builder.call(function, [args[0]])

        return x(x), codegen

    return operation


sqrt = _unary("sqrt")
floor = _unary("floor")
absolute = _unary("fabs")


@intrinsic
def where_negative(typingctx, condition, x, y):
    """Return lanes: x in samples where condition (lanes) < 0, else y; x, y: lanes or numbers."""
    if not isinstance(condition, Lane):
        return None

    def codegen(context, builder, sig, args):
        lane = sig.args[0]
        zero = ir.Constant(context.get_value_type(lane), [0.0] * lane.count)
        negative = builder.fcmp_ordered("<", args[0], zero)
        x = _as_lane(context, builder, args[1], sig.args[1], lane)
        y = _as_lane(context, builder, args[2], sig.args[2], lane)
        return builder.select(negative, x, y)

    return condition(condition, x, y), codegen


@intrinsic
def any_negative(typingctx, x):
    """Return whether x (lanes) is below 0 in any sample (NaN is not). typingctx: numba's."""
    if not isinstance(x, Lane):
        return None

    def codegen(context, builder, sig, args):
        lane = sig.args[0]
        zero = ir.Constant(context.get_value_type(lane), [0.0] * lane.count)
        bits = ir.IntType(lane.count)
        mask = builder.bitcast(builder.fcmp_ordered("<", args[0], zero), bits)
        return builder.icmp_unsigned("!=", mask, ir.Constant(bits, 0))

    return types.boolean(x), codegen
