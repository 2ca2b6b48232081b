"""Runs that compile the time loops which several test files share, each loop by one function.

Loops of a family share most of their code, which a process compiles once.
"""

from tests.highfi.contact.test_deformed_wall import Pressed
from tests.highfi.dynamics.test_mounts import DAMPED, SOFT
from tests.highfi.support import COARSE, begun, tiny
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import IMMOVABLE, PAPER_PAD, scene
from tests.pushed import SPRING
from tipoff import highfi, lowfi

LINEAR = {"law": "linear", "clearance": 1e-5, "stiffness": 7e7, "damping": 0.0}
HUNT_CROSSLEY = {
    "law": "hunt-crossley",
    "clearance": 1e-5,
    "stiffness": 7e7,
    "exponent": 1.5,
    "dissipation": 1.0,
}
NO_THRUST = {"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 0.0}
STICKING = {
    "law": "sticking",
    "static": 0.3,
    "dynamic": 0.3,
    "stiffness": 1e7,
    "damping": 1e4,
}
NO_FORCE = {"kind": "constant", "force": 0.0, "duration": 1e-3}
FIXED = {"platform": None}
FOUR = lowfi.Numerics(modes=4)


def four_modes() -> None:
    """The surrogate on compliant rails that vibrate."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=FOUR)


def without_modes() -> None:
    """The surrogate on compliant rails without inertia."""
    none = lowfi.Numerics(modes=0)
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=none)


def weight_without_modes() -> None:
    """A payload without thrust or friction on compliant rails of a fixed platform."""
    absent = FIXED | {"friction": None, "thrust_offset": None}
    alone = REFERENCE.replace(absent | {"thrust": NO_FORCE, "gravity": {"z": -9.80665}})
    none = lowfi.Numerics(modes=0)
    lowfi.run(alone, "compliant", compliance=reference_compliance(), numerics=none)


def finite_elements() -> None:
    """The reference on the small scene."""
    highfi.run(tiny(), COARSE)


def fixed_rails() -> None:
    """The reference on a fixed platform."""
    begun(tiny(platform=None))


def fixed_rails_under_a_curve() -> None:
    """The same, with the curve of a thrust that has no offset."""
    begun(tiny(platform=None, thrust=NO_FORCE, thrust_offset=None))


def damped_rails() -> None:
    """The reference with structural damping."""
    begun(tiny(**DAMPED))


def rails_on_joints() -> None:
    """The reference with soft mounts."""
    begun(tiny(**SOFT))


def hexahedra() -> None:
    """The reference on hexahedra that are no extrusion."""
    Pressed("twisted").energy((0.0, 0.0, 0.0))


def tetrahedra() -> None:
    """The reference on tetrahedra."""
    Pressed("tetrahedra").energy((0.0, 0.0, 0.0))


def springs() -> None:
    """The surrogate on springs."""
    lowfi.run(REFERENCE, "springs")


def springs_on_a_fixed_platform() -> None:
    """The surrogate on springs, without a platform."""
    lowfi.run(REFERENCE.replace(FIXED), "springs")


def body_on_impact() -> None:
    """One body on the contact law of the paper."""
    lowfi.run(scene(1e-3, 1e-3, contact=PAPER_PAD), "springs")


def body_on_linear() -> None:
    """One body on a linear contact law."""
    lowfi.run(scene(1e-3, 1e-3, contact=LINEAR), "springs")


def body_on_hunt_crossley() -> None:
    """One body on the contact law of Hunt and Crossley."""
    lowfi.run(scene(1e-3, 1e-3, contact=HUNT_CROSSLEY), "springs")


def body_that_sticks() -> None:
    """One body on a linear contact law with friction that sticks."""
    lowfi.run(scene(1e-3, 1e-3, contact=LINEAR, friction=STICKING), "springs")


def body_that_sticks_to_a_platform() -> None:
    """The same on a platform."""
    lowfi.run(scene(1e-3, 1e-3, contact=LINEAR, friction=STICKING, thrust=NO_THRUST), "springs")


def free_body() -> None:
    """One body without contact."""
    lowfi.run(scene(1e-3, 1e-3), "springs")


def two_free_bodies() -> None:
    """A payload and a platform without contact."""
    lowfi.run(scene(1e-3, 1e-3, thrust=NO_THRUST), "springs")


def free_payload() -> None:
    """A payload without contact on a fixed platform."""
    lowfi.run(REFERENCE.replace(FIXED | {"contact": None, "friction": None}), "springs")


def pushed_payload() -> None:
    """A payload without contact that springs push from a platform."""
    lowfi.run(scene(1e-3, 1e-3, thrust=SPRING, platform=IMMOVABLE), "springs")


def pushed_from_rails() -> None:
    """The same in the reference."""
    begun(tiny(contact=None, friction=None, thrust=SPRING))


# Runs that watch modes, or choose them, have the same kernels.
COMPLIANT = (four_modes, without_modes, weight_without_modes)
FINITE_ELEMENTS = (
    finite_elements,
    fixed_rails,
    fixed_rails_under_a_curve,
    damped_rails,
    rails_on_joints,
    hexahedra,
    tetrahedra,
    pushed_from_rails,
)
BODIES = (
    body_on_impact,
    body_on_linear,
    body_on_hunt_crossley,
    body_that_sticks,
    body_that_sticks_to_a_platform,
    free_body,
)
PAYLOADS = (springs, springs_on_a_fixed_platform, free_payload, two_free_bodies, pushed_payload)
FAMILIES = (FINITE_ELEMENTS, COMPLIANT, BODIES, PAYLOADS)  # the longest first
