"""Runs that compile the time loops which several test files share, each loop by one function.

Loops of a family share most of their code, which a process compiles once.
"""

from tests.highfi.contact.test_deformed_wall import Pressed
from tests.highfi.support import COARSE, tiny
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import highfi, lowfi
from tipoff.mechanics.rail_compliance import LOW_DEGREE

FOUR = lowfi.Numerics(modes=4)


def compliant() -> None:
    """The surrogate on compliant rails."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=FOUR)


def compliant_cases() -> None:
    """The same with the patterns of many cases."""
    few = reference_compliance().of_degree(LOW_DEGREE)
    lowfi.run(REFERENCE, "compliant", compliance=few, numerics=FOUR)


def finite_elements() -> None:
    """The reference on the small scene."""
    highfi.run(tiny(), COARSE)


def hexahedra() -> None:
    """The reference on hexahedra that are no extrusion."""
    Pressed("twisted").energy((0.0, 0.0, 0.0))


def tetrahedra() -> None:
    """The reference on tetrahedra."""
    Pressed("tetrahedra").energy((0.0, 0.0, 0.0))


def springs() -> None:
    """The surrogate on springs, and without contact."""
    lowfi.run(REFERENCE, "springs")


FINITE_ELEMENTS = (finite_elements, hexahedra, tetrahedra)
SURROGATE = (compliant, compliant_cases, springs)
FAMILIES = (FINITE_ELEMENTS, SURROGATE)
