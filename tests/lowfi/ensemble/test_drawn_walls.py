"""Ensembles on walls that are not straight as drawn."""

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.contact.compliant.test_drawn_walls import curved, with_offset
from tipoff import lowfi

ANGLE = "thrust_offset.misalignment.axial"
CASES = [{ANGLE: "0.1 deg"}, {ANGLE: "0.3 deg"}]
NONE = lowfi.Numerics(modes=0)


@pytest.mark.slow  # two time loops of their own
@pytest.mark.parametrize("model", ["springs", "compliant"])
def test_a_case_is_the_run_of_its_scene(model):
    """Bit for bit. Control: on straight walls the answer is another one."""
    drawn, straight = with_offset(10.0 * curved()), reference_compliance()
    if model == "springs":
        drawn, straight = drawn.rigid(), None
    found = lowfi.run_many(REFERENCE, CASES, model, compliance=drawn, numerics=NONE)
    for case, rate in zip(CASES, found.rate):
        scene = REFERENCE.replace(case)
        alone = lowfi.run(scene, model, compliance=drawn, numerics=NONE)
        assert alone.status == "exited"
        np.testing.assert_array_equal(rate, alone.outcome.rate)
        plain = lowfi.run(scene, model, compliance=straight, numerics=NONE)
        assert np.abs(np.subtract(plain.outcome.rate, alone.outcome.rate)).max() > 1e-3
