"""Runs that compile the time loops which several test files share, each loop by one function.

Loops of a family share most of their code, which a process compiles once.
"""

from tests.highfi.contact.test_deformed_wall import RELIEF, Pressed, scene, wall
from tests.highfi.support import COARSE, begun, loop_on, tiny
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tipoff import highfi, lowfi
from tipoff.mechanics.rail_compliance import LOW_DEGREE

FIXED = {"platform": None}
FOUR = lowfi.Numerics(modes=4)


def compliant() -> None:
    """The surrogate on compliant rails."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=FOUR)


def compliant_cases() -> None:
    """The same with the patterns of many cases."""
    few = reference_compliance().of_degree(LOW_DEGREE)
    lowfi.run(REFERENCE, "compliant", compliance=few, numerics=FOUR)


def compliant_on_a_fixed_platform() -> None:
    """The surrogate on compliant rails of a fixed platform."""
    fixed = REFERENCE.replace(FIXED)
    lowfi.run(fixed, "compliant", compliance=reference_compliance(), numerics=FOUR)


def finite_elements() -> None:
    """The reference on the small scene."""
    highfi.run(tiny(), COARSE)


def fixed_rails() -> None:
    """The reference on a fixed platform."""
    begun(tiny(platform=None))


def hexahedra() -> None:
    """The reference on hexahedra that are no extrusion."""
    Pressed("twisted").energy((0.0, 0.0, 0.0))


def tetrahedra() -> None:
    """The reference on tetrahedra."""
    Pressed("tetrahedra").energy((0.0, 0.0, 0.0))


def hexahedra_on_a_fixed_platform() -> None:
    """The same without a platform."""
    loop_on(scene(RELIEF).replace(FIXED), wall("twisted")).stepper.evaluate()


def tetrahedra_on_a_fixed_platform() -> None:
    """The same without a platform."""
    loop_on(scene(RELIEF).replace(FIXED), wall("tetrahedra")).stepper.evaluate()


def springs() -> None:
    """The surrogate on springs, and without contact."""
    lowfi.run(REFERENCE, "springs")


def springs_on_a_fixed_platform() -> None:
    """The same without a platform."""
    lowfi.run(REFERENCE.replace(FIXED), "springs")


COMPLIANT = (compliant, compliant_cases, compliant_on_a_fixed_platform)
FINITE_ELEMENTS = (
    finite_elements,
    fixed_rails,
    hexahedra,
    tetrahedra,
    hexahedra_on_a_fixed_platform,
    tetrahedra_on_a_fixed_platform,
)
SPRINGS = (springs, springs_on_a_fixed_platform)
FAMILIES = (FINITE_ELEMENTS, COMPLIANT, SPRINGS)  # the longest first
