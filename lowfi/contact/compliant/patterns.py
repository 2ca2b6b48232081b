"""Patterns of the displacement of a wall under a face, xi^i eta^j, in the order of their degree i + j,
then of j (``mechanics.rail_compliance``).

Kernels know the degree when they are compiled, as the length of a tuple: their loops over patterns
have constant bounds."""

from tipoff.kernels.jit import kernel


@kernel
def degree(levels):
    """Highest degree; ``levels`` is a tuple of one more elements."""
    return len(levels) - 1


@kernel
def count(levels):
    """Number of patterns."""
    return len(levels) * (len(levels) + 1) // 2


@kernel
def number(i, j):
    """Number of the pattern xi^i eta^j."""
    return (i + j) * (i + j + 1) // 2 + j


@kernel
def value(levels, amounts, xi, eta):
    """Sum of ``amounts`` (p,) times patterns at a point."""
    total, across = 0.0, 1.0
    for j in range(len(levels)):
        along = 0.0
        for i in range(degree(levels) - j, -1, -1):
            along = along * xi + amounts[number(i, j)]
        total += along * across
        across *= eta
    return total


@kernel
def by_xi(levels, amounts, xi, eta):
    """Derivative by xi of ``value``."""
    total, across = 0.0, 1.0
    for j in range(len(levels) - 1):
        along = 0.0
        for i in range(degree(levels) - j, 0, -1):
            along = along * xi + i * amounts[number(i, j)]
        total += along * across
        across *= eta
    return total
