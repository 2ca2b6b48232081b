"""Records of arrays that kernels receive by their address.

Numba passes a named tuple to a function as its parts, seven words for each array. A record of fifty
arrays becomes hundreds of arguments of each function. A record that is passed by reference is one pointer
to a structure, as in C. A function reads only the members that it uses, and the kernels of the surrogate
compile in 100 s instead of more than 200 s.
"""

from typing import TypeVar

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import (
    NativeValue,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

_Record = TypeVar("_Record", bound=tuple)


class Reference(types.NamedTuple):
    """Numba's type of a record that is passed by reference."""

    def __init__(self, members: tuple, python: type):
        super().__init__(members, python)
        self.name = f"reference to {self.name}"  # Numba makes names of functions from it


def by_reference(python: type[_Record]) -> type[_Record]:
    """Decorator of a named tuple class: Python passes its records to kernels by address. Kernels
    read such records and do not make them."""

    @typeof_impl.register(python)
    def type_of(value, context):
        members = tuple(typeof_impl(item, context) for item in value)
        return None if None in members else Reference(members, python)

    return python


@register_model(Reference)
class _ReferenceModel(models.PrimitiveModel):
    """Pointer to a structure of the members; a member that is a record is inside it."""

    def __init__(self, manager, kind):
        parts = [manager.lookup(member).get_value_type() for member in kind.types]
        self.structure = ir.LiteralStructType(
            [
                part.pointee if isinstance(member, Reference) else part
                for part, member in zip(parts, kind.types)
            ]
        )
        super().__init__(manager, kind, self.structure.as_pointer())

    def from_argument(self, builder, value):
        """The pointer. Nothing writes to a record, so LLVM may read a part once."""
        for attribute in ("noalias", "captures(none)"):
            value.add_attribute(attribute)
        return value


@lower_getattr_generic(Reference)
def _field(context, builder, kind, value, name):
    index = kind.fields.index(name)
    place, member = cgutils.gep_inbounds(builder, value, 0, index), kind.types[index]
    found = place if isinstance(member, Reference) else builder.load(place)
    return impl_ret_borrowed(context, builder, member, found)


@unbox(Reference)
def _from_python(kind, record, compiler):
    builder = compiler.builder
    place = cgutils.alloca_once(builder, compiler.context.get_value_type(kind).pointee)
    failed = cgutils.alloca_once_value(builder, cgutils.false_bit)
    cleanups = []
    _fill(kind, record, place, failed, cleanups, compiler)

    def cleanup():
        for each in reversed(cleanups):
            each()

    return NativeValue(place, is_error=builder.load(failed), cleanup=cleanup if cleanups else None)


def _fill(kind, record, place, failed, cleanups, compiler) -> None:
    """Write the members of a Python ``record`` to the structure at ``place``."""
    builder = compiler.builder
    for index, member in enumerate(kind.types):
        item = compiler.pyapi.tuple_getitem(record, index)
        here = cgutils.gep_inbounds(builder, place, 0, index)
        if isinstance(member, Reference):
            _fill(member, item, here, failed, cleanups, compiler)
            continue
        native = compiler.unbox(member, item)
        builder.store(native.value, here)
        with builder.if_then(native.is_error, likely=False):
            builder.store(cgutils.true_bit, failed)
        if native.cleanup is not None:
            cleanups.append(native.cleanup)
