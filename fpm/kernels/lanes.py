"""SIMD lanes as a numba type: one value holds the same quantity of several samples.

A kernel written with lanes reads like scalar code, yet every operation is one LLVM vector
instruction over all samples of the batch. This does not lean on the auto-vectoriser, which gives up
silently (on index wrap-around, on alias checks, on large loop bodies).

A register holds eight ``float64`` or sixteen ``float32`` (512 bits; LLVM splits it on narrower
machines). The lanes never mix, so a sample's numbers do not depend on which samples run beside it.
Multiply-add may be fused (``contract``); nothing else is relaxed: one machine, the same bits.

Arrays hold lanes along the last, contiguous axis: ``(rows, fields, WIDTH)``; ``load(a, i, k)``
reads the lanes ``a[i, k, :]``. With a pair of rows ``(i, j)`` it reads both into a lane type of
twice the width, and the same code then works on two particles or elements at once: their chains of
operations interleave, which hides the latency of the arithmetic units."""

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
    """Numba type of one number of several samples side by side (lanes), in a 512-bit register; of
    two registers for a pair of rows. scalar: numba's type of each; registers: 1 or 2."""

    def __init__(self, scalar, registers=1):
        self.scalar = scalar
        self.count = registers * 512 // scalar.bitwidth
        super().__init__(name=f"Lane({scalar} x {self.count})")


@register_model(Lane)
class _LaneModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        element = ir.DoubleType() if fe_type.scalar == types.float64 else ir.FloatType()
        super().__init__(dmm, fe_type, ir.VectorType(element, fe_type.count))


LANES = {scalar: (Lane(scalar), Lane(scalar, 2)) for scalar in (types.float64, types.float32)}
ALL_LANES = [lane for pair in LANES.values() for lane in pair]
PAIR = types.UniTuple(types.intp, 2)


def _splat(context, builder, value, scalar_type, lane):
    """Repeat a scalar in every lane."""
    value = context.cast(builder, value, scalar_type, lane.scalar)
    vector_type = context.get_value_type(lane)
    blank = ir.Constant(vector_type, ir.Undefined)
    start = builder.insert_element(blank, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(start, start, _mask([0] * lane.count))


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
    for lane in ALL_LANES:
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
    for lane in ALL_LANES:

        @lower_builtin(operator.neg, lane)
        def lower(context, builder, sig, args):
            return builder.fneg(args[0])

    type_operator(operator.neg, [lane(lane) for lane in ALL_LANES])


_register_negative()


def _pointer(context, builder, array_type, array, row, field):
    """Address of ``array[row, field, 0]`` of a C-contiguous array (no index wrap-around)."""
    place = context.data_model_manager[array_type].get_field_position
    fields = builder.extract_value(array, [place("shape"), 1])
    lane = LANES[array_type.dtype][0]
    index = builder.add(builder.mul(row, fields), field)
    index = builder.mul(index, ir.Constant(index.type, lane.count))
    address = builder.gep(builder.extract_value(array, place("data")), [index])
    return builder.bitcast(address, context.get_value_type(lane).as_pointer())


def lane_of(array, row):
    """Return the lane type that `row` (an index or a pair; numba's types) of `array` is read into;
    None if unfit."""
    if not (isinstance(array, types.Array) and array.ndim == 3 and array.layout == "C"):
        return None
    return LANES[array.dtype][row == PAIR]


def _addresses(context, builder, sig, args, count):
    """Addresses of the lanes at args[1] (row, or each of a pair of rows) of args[0], in `count`
    fields from args[2] on."""
    field = context.cast(builder, args[2], sig.args[2], types.intp)
    if sig.args[1] == PAIR:
        rows = [builder.extract_value(args[1], k) for k in range(2)]
    else:
        rows = [context.cast(builder, args[1], sig.args[1], types.intp)]
    first = [_pointer(context, builder, sig.args[0], args[0], row, field) for row in rows]
    rest = [[builder.gep(a, [WORD(k)]) for a in first] for k in range(1, count)]
    return [first, *rest]


def read(context, builder, sig, args, count=1):
    """Return the lanes in `count` fields of an array, as `load` reads one; arguments as numba gives
    them to what writes the code of a function of (array, row, field, ...)."""
    lane, values = lane_of(*sig.args[:2]), []
    align = lane.scalar.bitwidth // 8
    for addresses in _addresses(context, builder, sig, args, count):
        parts = [builder.load(address, align=align) for address in addresses]
        whole = _mask(range(lane.count))
        values.append(parts[0] if len(parts) == 1 else builder.shuffle_vector(*parts, whole))
    return values


def write(context, builder, sig, args, values):
    """Write lanes `values` to as many fields of an array, as `store` does one; the others: `read`.
    Returns what a function without a result gives."""
    lane = lane_of(*sig.args[:2])
    align, half = lane.scalar.bitwidth // 8, lane.count // 2
    fields = _addresses(context, builder, sig, args, len(values))
    for addresses, value in zip(fields, values, strict=True):
        if len(addresses) == 1:
            builder.store(value, addresses[0], align=align)
        else:
            for k, address in enumerate(addresses):
                part = _mask(range(k * half, (k + 1) * half))
                builder.store(builder.shuffle_vector(value, value, part), address, align=align)
    return context.get_dummy_value()


def _mask(indices):
    index = ir.IntType(32)
    return ir.Constant(ir.VectorType(index, len(indices)), [ir.Constant(index, i) for i in indices])


@intrinsic
def load(typingctx, array, row, field):
    """Return the lanes (numbers of samples side by side) ``array[row, field, :]`` of a C-contiguous
    array (rows, fields, width). row: index, or two for twice the width; typingctx: numba's."""
    lane = lane_of(array, row)
    return lane and (lane(array, row, field), lambda *context: read(*context)[0])


@intrinsic
def store(typingctx, array, row, field, value):
    """Write `value`, lanes (numbers of samples side by side) or one number for all, to ``array[row,
    field, :]``. row: index, or two different ones for twice the width; typingctx: numba's."""

    def codegen(context, builder, sig, args):
        vector = _as_lane(context, builder, args[3], sig.args[3], lane)
        return write(context, builder, sig, args, [vector])

    lane = lane_of(array, row)
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
