"""Named tuples handed to kernels by reference, so that code is compiled in half the time.

numba hands a named tuple on field by field, and an array as eleven numbers: a kernel that sees a
World and a kind's arrays has some four hundred arguments, packed and unpacked at every call. By
reference they are two."""

from collections.abc import Callable

from llvmlite import ir
from numba import types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model

from fpm.kernels.lanes import WORD


class Reference(types.Type):
    """Numba type of a reference to a named tuple; its fields are read as the tuple's own.
    tuple_type: numba's type of the tuple."""

    def __init__(self, tuple_type: types.BaseNamedTuple):
        self.tuple_type = tuple_type
        self.instance_class = tuple_type.instance_class
        super().__init__(name=f"Reference({tuple_type})")

    def field(self, name: str) -> types.Type:
        """Return the numba type of the field `name`; of a named tuple, that of its reference."""
        field_type = self.tuple_type[self.tuple_type.fields.index(name)]
        return Reference(field_type) if isinstance(field_type, types.BaseNamedTuple) else field_type


@register_model(Reference)
class _ReferenceModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, dmm.lookup(fe_type.tuple_type).get_value_type().as_pointer())


@infer_getattr
class _Fields(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference, name):
        if name in reference.tuple_type.fields:
            return reference.field(name)
        return None


@lower_getattr_generic(Reference)
def _field(context, builder, reference, value, name):
    place = [ir.IntType(32)(0), ir.IntType(32)(reference.tuple_type.fields.index(name))]
    pointer = builder.gep(value, place, inbounds=True)
    return pointer if isinstance(reference.field(name), Reference) else builder.load(pointer)


@intrinsic
def local_copy(typingctx, reference):
    """Return a reference to a copy of what `reference` refers to, in the function's own memory: the
    compiler then knows that no array overlaps with it. typingctx: numba's."""

    def codegen(context, builder, sig, args):
        copy = _room(builder, args[0].type.pointee)
        size = WORD(context.get_abi_sizeof(args[0].type.pointee))
        address = ir.IntType(8).as_pointer()
        memcpy = builder.module.declare_intrinsic("llvm.memcpy", [address, address, WORD])
        places = [builder.bitcast(pointer, address) for pointer in (copy, args[0])]
        builder.call(memcpy, [*places, size, ir.IntType(1)(0)])
        return copy

    return reference(reference), codegen


def _room(builder, kind):
    """Room for a value in the memory of the function, once, also within a loop."""
    with builder.goto_entry_block():
        return builder.alloca(kind)


def calls_of(number: int) -> Callable:
    """Return what writes the code of a hook's calls, for `intrinsic`. number: of the hook.
    Arguments: a Calls by reference, and those of the kernels; these get the number of the call."""

    def codegen(context, builder, sig, args):
        calls, values = sig.args[0], args[1:]
        place = context.data_model_manager[calls.field("starts")].get_field_position("data")

        def item(name, index):
            array = _field(context, builder, calls, args[0], name)
            return builder.load(builder.gep(builder.extract_value(array, place), [index]))

        arg_types = [types.voidptr, *sig.args[1:], types.intp]
        signature = context.call_conv.get_function_type(types.none, arg_types)
        packer = context.get_arg_packer(arg_types)
        result = _room(builder, signature.args[0].pointee)
        no_error = signature.args[1](None)  # kernels raise none
        start, end = item("starts", WORD(number)), item("starts", WORD(number + 1))
        origin = builder.block
        test, body, end_block = (builder.append_basic_block(f"calls.{k}") for k in range(3))
        builder.branch(test)
        builder.position_at_end(test)
        index = builder.phi(WORD)
        index.add_incoming(start, origin)
        builder.cbranch(builder.icmp_signed("<", index, end), body, end_block)
        builder.position_at_end(body)
        row = builder.mul(index, WORD(2))
        code = builder.inttoptr(item("addresses", row), signature.as_pointer())
        data = item("addresses", builder.add(row, WORD(1)))
        part = builder.inttoptr(data, context.get_value_type(types.voidptr))
        arguments = packer.as_arguments(builder, [part, *values, builder.sub(index, start)])
        builder.call(code, [result, no_error, *arguments])
        index.add_incoming(builder.add(index, WORD(1)), builder.block)
        builder.branch(test)
        builder.position_at_end(end_block)
        return context.get_dummy_value()

    return codegen
