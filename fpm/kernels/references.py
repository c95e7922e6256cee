"""Named tuples handed to kernels by reference, so that code is compiled in half the time.

numba hands a named tuple on field by field, and an array as eleven numbers: a kernel that sees a
World and a kind's arrays has some four hundred arguments, packed and unpacked at every call. By
reference they are two."""

from numba import types
from numba.core.cgutils import alloca_once, gep_inbounds, intp_t, raw_memcpy, unpack_tuple
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import intrinsic, lower_getattr_generic, models, register_model


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


@intrinsic
def call(typingctx, code, data, arguments):
    """Call compiled code. code: its address; data: that of the named tuple that it takes first, by
    reference; arguments: tuple of the others; typingctx: numba's."""

    def codegen(context, builder, sig, args):
        arg_types = [types.voidptr, *sig.args[2]]
        first = builder.inttoptr(args[1], context.get_value_type(types.voidptr))
        values = [first, *unpack_tuple(builder, args[2])]
        signature = context.call_conv.get_function_type(types.none, arg_types)
        function = builder.inttoptr(args[0], signature.as_pointer())
        packer = context.get_arg_packer(arg_types)
        result = alloca_once(builder, signature.args[0].pointee)
        no_error = signature.args[1](None)  # kernels raise none
        builder.call(function, [result, no_error, *packer.as_arguments(builder, values)])
        return context.get_dummy_value()

    return types.void(code, data, arguments), codegen
