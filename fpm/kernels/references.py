"""Named tuples handed to kernels by reference, so that code is compiled in half the time.

numba hands a named tuple on field by field, and an array as eleven numbers: a kernel that sees a
World and a kind's arrays has some four hundred arguments, packed and unpacked at every call. By
reference they are two."""

from collections.abc import Callable

from numba import types
from numba.core.cgutils import alloca_once, for_range_slice, gep_inbounds, intp_t, raw_memcpy
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import lower_getattr_generic, models, register_model

from fpm.kernels.inlining import intrinsic


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
    pointer = gep_inbounds(builder, value, 0, reference.tuple_type.fields.index(name))
    return pointer if isinstance(reference.field(name), Reference) else builder.load(pointer)


@intrinsic
def local_copy(typingctx, reference):
    """Return a reference to a copy of what `reference` refers to, in the function's own memory: the
    compiler then knows that no array overlaps with it. typingctx: numba's."""

    def codegen(context, builder, sig, args):
        size = intp_t(context.get_abi_sizeof(args[0].type.pointee))
        copy = alloca_once(builder, args[0].type.pointee)
        raw_memcpy(builder, copy, args[0], size, 1)
        return copy

    return reference(reference), codegen


def calls_of(number: int) -> Callable:
    """Return what writes the code of a hook's calls, for `intrinsic`. number: of the hook. Its
    arguments are a Calls by reference, and those of the kernels, which get as a last one the number
    of the call among those of the hook."""

    def codegen(context, builder, sig, args):
        calls, values = sig.args[0], args[1:]
        place = context.data_model_manager[calls.field("starts")].get_field_position("data")

        def item(name, index):
            array = _field(context, builder, calls, args[0], name)
            return builder.load(builder.gep(builder.extract_value(array, place), [index]))

        arg_types = [types.voidptr, *sig.args[1:], types.intp]
        signature = context.call_conv.get_function_type(types.none, arg_types)
        packer = context.get_arg_packer(arg_types)
        result = alloca_once(builder, signature.args[0].pointee)
        no_error = signature.args[1](None)  # kernels raise none
        start, end = item("starts", intp_t(number)), item("starts", intp_t(number + 1))
        with for_range_slice(builder, start, end, intp_t(1)) as (index, count):
            row = builder.mul(index, intp_t(2))
            code = builder.inttoptr(item("addresses", row), signature.as_pointer())
            data = item("addresses", builder.add(row, intp_t(1)))
            part = builder.inttoptr(data, context.get_value_type(types.voidptr))
            arguments = packer.as_arguments(builder, [part, *values, count])
            builder.call(code, [result, no_error, *arguments])
        return context.get_dummy_value()

    return codegen
