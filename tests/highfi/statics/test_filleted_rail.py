"""A rail with a fillet on joints has no singularity: deflection, frequencies and the stress in the
inner corner approach those of other elements with about the second power of the element size. A
sharp rail on rigid mounts does not."""

import numpy as np
import pytest

from tests.highfi.statics import quadratic_rail as other
from tests.highfi.statics.loaded_rail import MATERIAL, rail, solved
from tipoff.mechanics.laws.mount_stiffness import MountStiffness

FILLET = 2e-3  # m
JOINT = MountStiffness(normal=1e13, shear=5e12)
# ``other.solve(2e-3, MATERIAL, JOINT, fillet=FILLET, along=4e-3)``. Elements twice as long along the
# rail change the deflection by 0.3 %, the frequencies by 0.25 % and the stress by 1 %.
EXACT = other.Solution(
    1.39037985e-05, np.array([2504.70849, 2891.14612, 4573.76417, 5090.28088]), 6.11548e6
)
# A sharp rail on rigid mounts: ``other.solve`` at 4 and 2 mm, extrapolated linearly, to three digits.
SHARP = other.Solution(8.47e-6, np.array([3250.0, 3357.0, 6170.0, 6639.0]))
SIZES = 4e-3, 2e-3  # m


@pytest.fixture(scope="module")
def filleted():
    """The rail in elements of ``SIZES``."""
    return [solved(rail(size, FILLET), JOINT) for size in SIZES]


def errors(found: other.Solution, exact: other.Solution) -> np.ndarray:
    """Relative errors (3,) of deflection, the four frequencies (their root mean square) and stress."""
    frequencies = found.frequencies / exact.frequencies - 1.0
    return np.array(
        [
            abs(found.deflection / exact.deflection - 1.0),
            np.sqrt(np.mean(frequencies**2)),
            abs(found.stress / exact.stress - 1.0),
        ]
    )


@pytest.mark.case("O75")
def test_a_filleted_rail_is_near_other_elements(filleted):
    """Control: the mesh of 4 mm is twice as far off in its deflection."""
    coarse, fine = (errors(each, EXACT) for each in filleted)
    assert filleted[1].deflection == pytest.approx(EXACT.deflection, rel=0.025)
    assert (fine < [0.025, 0.01, 0.22]).all()
    assert coarse[0] > 2.0 * fine[0] and (fine < coarse).all()


@pytest.mark.slow
def test_kept_values_are_those_of_quadratic_hexahedra():
    exact = other.solve(2e-3, MATERIAL, JOINT, fillet=FILLET, along=4e-3)
    assert exact.deflection == pytest.approx(EXACT.deflection, rel=1e-8)
    assert exact.frequencies == pytest.approx(EXACT.frequencies, rel=1e-8)
    assert exact.stress == pytest.approx(EXACT.stress, rel=1e-5)


@pytest.mark.case("O75")
@pytest.mark.slow
def test_a_filleted_rail_on_joints_converges_with_the_second_power(filleted):
    """From 2 to 1 mm. From 4 to 2 mm the errors do not show the power yet: the walls have one element
    across and then two, and the elements are as large as the fillet."""
    finest = solved(rail(1e-3, FILLET), JOINT)
    power = np.log2(errors(filleted[1], EXACT) / errors(finest, EXACT))
    assert (errors(finest, EXACT) < [0.007, 0.003, 0.06]).all()
    assert (power > 1.5).all()


@pytest.mark.case("O75")
def test_a_sharp_rail_on_rigid_mounts_does_not():
    """Control: deflection and frequencies converge with less than the first power, and the stress in
    the corner grows."""
    found = [solved(rail(size), None) for size in SIZES]
    power = np.log2(errors(found[0], SHARP)[:2] / errors(found[1], SHARP)[:2])
    assert (power < 0.9).all()
    assert found[1].stress > 1.3 * found[0].stress
