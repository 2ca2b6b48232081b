"""Runs that compile the time loops which several test files share, each loop by one function."""

from tests.highfi.contact.test_deformed_wall import Pressed
from tests.highfi.dynamics.test_mounts import DAMPED, SOFT
from tests.highfi.support import COARSE, begun, tiny
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import PAPER_PAD, scene
from tipoff import highfi, lowfi
from tipoff.lowfi.run import Run

LINEAR = {"law": "linear", "clearance": 1e-5, "stiffness": 7e7, "damping": 0.0}
HUNT_CROSSLEY = {
    "law": "hunt-crossley",
    "clearance": 1e-5,
    "stiffness": 7e7,
    "exponent": 1.5,
    "dissipation": 1.0,
}
NO_THRUST = {"kind": "gaussian", "peak": 0.0, "width": 1e-3, "centre": 0.0}
FOUR = lowfi.Numerics(modes=4)


def four_modes() -> None:
    """The surrogate on compliant rails that vibrate."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=FOUR)


def four_modes_and_others_watched() -> None:
    """The same, as the choice of modes makes it."""
    Run(REFERENCE, FOUR, reference_compliance(), watches=True).begin()


def modes_watched() -> None:
    """The surrogate on compliant rails, its first run."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance())


def without_modes() -> None:
    """The surrogate on compliant rails without inertia."""
    none = lowfi.Numerics(modes=0)
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance(), numerics=none)


def finite_elements() -> None:
    """The reference on the small scene."""
    highfi.run(tiny(), COARSE)


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


def body_on_impact() -> None:
    """One body on the contact law of the paper."""
    lowfi.run(scene(1e-3, 1e-3, contact=PAPER_PAD), "springs")


def body_on_linear() -> None:
    """One body on a linear contact law."""
    lowfi.run(scene(1e-3, 1e-3, contact=LINEAR), "springs")


def body_on_hunt_crossley() -> None:
    """One body on the contact law of Hunt and Crossley."""
    lowfi.run(scene(1e-3, 1e-3, contact=HUNT_CROSSLEY), "springs")


def free_body() -> None:
    """One body without contact."""
    lowfi.run(scene(1e-3, 1e-3), "springs")


def two_free_bodies() -> None:
    """A payload and a platform without contact."""
    lowfi.run(scene(1e-3, 1e-3, thrust=NO_THRUST), "springs")


LOOPS = (
    four_modes_and_others_watched,
    four_modes,
    modes_watched,
    without_modes,
    finite_elements,
    damped_rails,
    rails_on_joints,
    hexahedra,
    tetrahedra,
    springs,
    body_on_impact,
    body_on_linear,
    body_on_hunt_crossley,
    free_body,
    two_free_bodies,
)
