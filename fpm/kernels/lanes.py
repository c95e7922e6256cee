"""SIMD lanes as a numba type: one value holds the same quantity of several samples.

A kernel written with lanes reads like scalar code, yet every operation is one LLVM vector
instruction over all samples of the batch. This does not lean on the auto-vectoriser, which gives up
silently (on index wrap-around, on alias checks, on large loop bodies).

A register holds eight numbers (512 bits; LLVM splits it on narrower machines). The lanes never mix,
so a sample's numbers do not depend on which samples run beside it. Multiply-add may be fused
(``contract``); nothing else is relaxed: one machine, the same bits.

Arrays hold lanes along the last, contiguous axis: ``(rows, fields, WIDTH)``; ``load(a, i, k)``
reads the lanes ``a[i, k, :]``."""

import operator

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, lower_builtin, models, register_model

from fpm.kernels.inlining import type_operator
from fpm.kernels.layout import WIDTH

ALIGN = 8  # of a number, bytes
CONTRACT = ("contract",)
WORD = ir.IntType(64)


class Lane(types.Type):
    """Numba type of one number of several samples side by side (lanes), in a 512-bit register."""

    def __init__(self):
        super().__init__(name="Lane")


@register_model(Lane)
class _LaneModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, ir.VectorType(ir.DoubleType(), WIDTH))


LANE = Lane()


def _as_lane(context, builder, value, value_type):
    """Return lanes as they are, and a scalar repeated in every lane."""
    if isinstance(value_type, Lane):
        return value
    value = context.cast(builder, value, value_type, types.float64)
    blank = ir.Constant(context.get_value_type(LANE), ir.Undefined)
    start = builder.insert_element(blank, value, ir.Constant(ir.IntType(32), 0))
    index = ir.IntType(32)
    mask = ir.Constant(ir.VectorType(index, WIDTH), [index(0)] * WIDTH)
    return builder.shuffle_vector(start, start, mask)


_BINARY = {
    operator.add: "fadd",
    operator.sub: "fsub",
    operator.mul: "fmul",
    operator.truediv: "fdiv",
}
_SCALARS = (types.float64, types.int64)


def _register_binary(op, instruction):
    pairs = [(LANE, LANE)] + [(LANE, s) for s in _SCALARS] + [(s, LANE) for s in _SCALARS]
    for lhs, rhs in pairs:

        @lower_builtin(op, lhs, rhs)
        def lower(context, builder, sig, args):
            x, y = (_as_lane(context, builder, *pair) for pair in zip(args, sig.args, strict=True))
            return getattr(builder, instruction)(x, y, flags=CONTRACT)

    numbers = (types.float64, types.int64)[: 1 if op is operator.truediv else 2]
    type_operator(op, [n(n, n) for n in numbers] + [LANE(*pair) for pair in pairs])


for _op, _instruction in _BINARY.items():
    _register_binary(_op, _instruction)


@lower_builtin(operator.neg, LANE)
def _negative(context, builder, sig, args):
    return builder.fneg(args[0])


type_operator(operator.neg, [LANE(LANE)])


def is_readable(array):
    """Return whether lanes are read from rows of `array` (numba's type)."""
    is_fit = isinstance(array, types.Array) and array.ndim == 3 and array.layout == "C"
    return is_fit and array.dtype == types.float64


def _addresses(context, builder, sig, args, count):
    """Addresses of the lanes in row args[1] of the C-contiguous array args[0] (no index
    wrap-around), in `count` fields from args[2] on."""
    row, field = (context.cast(builder, args[k], sig.args[k], types.intp) for k in (1, 2))
    place = context.data_model_manager[sig.args[0]].get_field_position
    fields = builder.extract_value(args[0], [place("shape"), 1])
    index = builder.add(builder.mul(row, fields), field)
    index = builder.mul(index, WORD(WIDTH))
    address = builder.gep(builder.extract_value(args[0], place("data")), [index])
    first = builder.bitcast(address, context.get_value_type(LANE).as_pointer())
    return [first, *(builder.gep(first, [WORD(k)]) for k in range(1, count))]


def read(context, builder, sig, args, count=1):
    """Return the lanes in `count` fields of an array, as `load` reads one; arguments as numba gives
    them to what writes the code of a function of (array, row, field, ...)."""
    addresses = _addresses(context, builder, sig, args, count)
    return [builder.load(address, align=ALIGN) for address in addresses]


def write(context, builder, sig, args, values):
    """Write lanes `values` to as many fields of an array, as `store` does one; the others: `read`.
    Returns what a function without a result gives."""
    addresses = _addresses(context, builder, sig, args, len(values))
    for address, value in zip(addresses, values, strict=True):
        builder.store(value, address, align=ALIGN)
    return context.get_dummy_value()


@intrinsic
def load(typingctx, array, row, field):
    """Return the lanes (numbers of samples side by side) ``array[row, field, :]`` of a C-contiguous
    array (rows, fields, width). typingctx: numba's."""
    if is_readable(array):
        return LANE(array, row, field), lambda *context: read(*context)[0]
    return None


@intrinsic
def store(typingctx, array, row, field, value):
    """Write `value`, lanes or one number for all, to ``array[row, field, :]``."""

    def codegen(context, builder, sig, args):
        return write(
            context, builder, sig, args, [_as_lane(context, builder, args[3], sig.args[3])]
        )

    return (types.void(array, row, field, value), codegen) if is_readable(array) else None


def _unary(name):
    @intrinsic
    def operation(typingctx, x):
        if not isinstance(x, Lane):
            return None

        def codegen(context, builder, sig, args):
            vector = context.get_value_type(sig.args[0])
            full_name, kind = f"llvm.{name}.v{WIDTH}f64", ir.FunctionType(vector, [vector])
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
        zero = ir.Constant(context.get_value_type(LANE), [0.0] * WIDTH)
        negative = builder.fcmp_ordered("<", args[0], zero)
        x = _as_lane(context, builder, args[1], sig.args[1])
        y = _as_lane(context, builder, args[2], sig.args[2])
        return builder.select(negative, x, y)

    return condition(condition, x, y), codegen


@intrinsic
def any_negative(typingctx, x):
    """Return whether x (lanes) is below 0 in any sample (NaN is not). typingctx: numba's."""
    if not isinstance(x, Lane):
        return None

    def codegen(context, builder, sig, args):
        zero = ir.Constant(context.get_value_type(LANE), [0.0] * WIDTH)
        bits = ir.IntType(WIDTH)
        mask = builder.bitcast(builder.fcmp_ordered("<", args[0], zero), bits)
        return builder.icmp_unsigned("!=", mask, ir.Constant(bits, 0))

    return types.boolean(x), codegen
