"""Named tuples handed to kernels by reference, so that code is compiled in half the time.

numba hands a named tuple on field by field, and an array as eleven numbers: a kernel that sees a
World and a kind's arrays has some four hundred arguments, packed and unpacked at every call. By
reference they are two. The compiled loop has no reference left."""

from numba import types
from numba.core.cgutils import alloca_once_value, gep_inbounds, unpack_tuple
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
def by_reference(typingctx, value):
    """Return a reference to a named tuple `value`, or for a tuple of them a tuple of references."""
    if isinstance(value, types.BaseNamedTuple):
        return Reference(value)(value), lambda _, builder, __, args: alloca_once_value(
            builder, *args
        )
    if not isinstance(value, types.BaseTuple):
        return None
    refs = types.BaseTuple.from_types([Reference(item_type) for item_type in value])

    def codegen(context, builder, sig, args):
        parts = unpack_tuple(builder, args[0], len(value))
        return context.make_tuple(builder, refs, [alloca_once_value(builder, p) for p in parts])

    return refs(value), codegen
