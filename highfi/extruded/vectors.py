"""LLVM code of vectors of eight doubles, for the loops that Numba does not keep in registers."""

from llvmlite import ir
from numba.core import cgutils

WIDTH = 8
INTEGER = ir.IntType(64)
VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
ZERO = ir.Constant(VECTOR, [0.0] * WIDTH)


class Vectors:
    """Writes instructions at the position of ``builder``."""

    def __init__(self, builder):
        self.builder = builder
        self._fma = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(VECTOR, [VECTOR] * 3), f"llvm.fmuladd.v{WIDTH}f64"
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
        one = self.builder.insert_element(
            ir.Constant(VECTOR, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0)
        )
        return self._shuffle(one, ir.Constant(VECTOR, ir.Undefined), [0] * WIDTH)

    def read(self, pointer, index):
        """Eight elements of an array from ``index`` on."""
        return self.builder.load(self._at(pointer, index), align=8)

    def write(self, vector, pointer, index):
        """Put a vector into an array from ``index`` on."""
        self.builder.store(vector, self._at(pointer, index), align=8)

    def variable(self):
        """A vector that changes; it lives in a register where one is free."""
        return cgutils.alloca_once(self.builder, VECTOR)

    def multiply_add(self, a, b, c):
        """a b + c"""
        return self.builder.call(self._fma, [a, b, c])

    def slide(self, a, b, by: int):
        """Eight elements of a followed by b, from number ``by`` on."""
        return self._shuffle(a, b, range(by, by + WIDTH))

    def _at(self, pointer, index):
        return self.builder.bitcast(self.builder.gep(pointer, [index]), VECTOR.as_pointer())

    def _shuffle(self, a, b, order):
        return self.builder.shuffle_vector(
            a, b, ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), list(order))
        )
