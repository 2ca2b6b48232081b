"""LLVM code of vectors of doubles, for the loops that Numba does not keep in registers.

Eight doubles are one register of 512 bits. A processor with narrower ones splits such a vector.
"""

from typing import Any, NamedTuple

from llvmlite import ir
from numba.core import cgutils

WIDTH = 8
INTEGER = ir.IntType(64)
ZERO = ir.Constant(ir.VectorType(ir.DoubleType(), WIDTH), [0.0] * WIDTH)


class Part(NamedTuple):
    """Numbers of which a processor keeps nine to twelve sums in its registers."""

    width: int  # doubles of a vector
    vectors: int


def fitting_part(codegen: Any) -> Part:
    """The part for the processor of Numba's code generator: 18 to 24 of 32 registers of 512 bits, or nine to
    twelve of 16 of 256 bits."""
    *_, features = codegen.magic_tuple()
    return Part(8, 2) if "+avx512f" in features.split(",") else Part(4, 1)


class Vectors:
    """Writes instructions on vectors of ``width`` doubles at the position of ``builder``."""

    def __init__(self, builder, width: int = WIDTH):
        self.builder, self.width = builder, width
        self.kind = ir.VectorType(ir.DoubleType(), width)
        self.zero = ir.Constant(self.kind, [0.0] * width)
        self._fma = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(self.kind, [self.kind] * 3),
            f"llvm.fmuladd.v{width}f64",
        )

    def plus(self, index, offset: int):
        """An index moved by a constant."""
        return self.builder.add(index, ir.Constant(INTEGER, offset))

    def times(self, index, factor: int):
        """An index times a constant."""
        return self.builder.mul(index, ir.Constant(INTEGER, factor))

    def number(self, pointer, index):
        """One element of an array."""
        return self.builder.load(self.builder.gep(pointer, [index]))

    def spread(self, scalar):
        """A vector of equal elements."""
        nothing = ir.Constant(self.kind, ir.Undefined)
        one = self.builder.insert_element(nothing, scalar, ir.Constant(ir.IntType(32), 0))
        return self._shuffle(one, nothing, [0] * self.width)

    def read(self, pointer, index):
        """Elements of an array, a vector from ``index`` on."""
        return self.builder.load(self._at(pointer, index), align=8)

    def write(self, vector, pointer, index):
        """Put a vector into an array from ``index`` on."""
        self.builder.store(vector, self._at(pointer, index), align=8)

    def variable(self):
        """A vector that changes; it lives in a register where one is free."""
        return cgutils.alloca_once(self.builder, self.kind)

    def numbers(self, count: int):
        """Room for so many numbers on the stack; a pointer to the first one."""
        return cgutils.alloca_once(self.builder, ir.DoubleType(), count)

    def multiply_add(self, a, b, c):
        """a b + c"""
        return self.builder.call(self._fma, [a, b, c])

    def slide(self, a, b, by: int):
        """A vector of the elements of a followed by b, from number ``by`` on."""
        return self._shuffle(a, b, range(by, by + self.width))

    def _at(self, pointer, index):
        return self.builder.bitcast(self.builder.gep(pointer, [index]), self.kind.as_pointer())

    def _shuffle(self, a, b, order):
        return self.builder.shuffle_vector(
            a, b, ir.Constant(ir.VectorType(ir.IntType(32), self.width), list(order))
        )
