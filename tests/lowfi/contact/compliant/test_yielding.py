"""A wall that friction presses away from its pad: contact has no solution, and the run says why."""

from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, handmade
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi.contact.compliant import yielding
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.mechanics.rail_compliance.patterns import DRAGGED

SCENE = REFERENCE.condition("phi0")
FACES, FLEXIBILITY, FREQUENCY, SHARE = 16, 1e-7, 3e3, 0.99  # m/N, rad/s, of the mode in F
MU = SCENE.friction.dynamic


def walls(drag: float, drives: bool = True):
    """Each face alone on its rail moves by its mean pressure, nearly all of it in one mode, and by
    ``drag`` times as much under friction, which ``drives`` the mode in this proportion."""
    entries = {(face, 0, face, 0): FLEXIBILITY for face in range(FACES)}
    found = handmade(SCENE, entries, np.arange(FACES))
    shape = np.zeros((2, FACES, PATTERNS, 1))
    shape[:, :, 0] = FREQUENCY * np.sqrt(SHARE * FLEXIBILITY)
    dragged = np.zeros((2, FACES, 1, DRAGGED, DRAGGED))
    dragged[..., 0, 0] = drag * FLEXIBILITY / MU
    return replace(
        found,
        shape=shape,
        frequency=np.full((FACES, 1), FREQUENCY),
        dragged=dragged,
        dragged_shape=drag / MU * shape[:, :, :DRAGGED] if drives else None,
    )


@pytest.mark.parametrize("modes, drag", [(0, -0.5), (1, -0.5), (1, 0.0)])
def test_the_least_share_is_that_of_a_spring_in_series(modes, drag):
    """The mean of the wall is a spring of its own: 1 + k A (F + mu D), both without the share of the
    mode. Control: with all of D beside the mode it would be negative."""
    run = SingleRun(SCENE, Numerics(modes=modes), walls(drag))
    compliance = run.system.compliance
    compliance.workspace.part[:, 1] = 1.0
    half = compliance.half[0]
    stiffness = SCENE.contact.interface_stiffness * 4.0 * half[0] * abs(half[1])
    rest = FLEXIBILITY * (1.0 - modes * SHARE) * (1.0 + drag)
    found = yielding.least_share(compliance, 0, compliance.origin + 0.1)
    assert found == pytest.approx(min(1.0, 1.0 + stiffness * rest), rel=1e-6)
    whole = FLEXIBILITY * (1.0 - modes * SHARE + drag)
    assert (1.0 + stiffness * whole < 0.0) == (modes == 1 and drag < 0.0)


def test_friction_that_drives_the_modes_leaves_the_wall_a_solution():
    """Control: friction that moves the wall as much, but not its mode, leaves none."""
    numerics = Numerics(modes=1)
    assert lowfi.run(SCENE, compliance=walls(-0.5), numerics=numerics).status == "exited"
    failed = lowfi.run(SCENE, compliance=walls(-0.5, drives=False), numerics=numerics)
    assert failed.status == "diverged"


def test_a_run_says_that_friction_leaves_the_wall_no_solution():
    """Friction that moves the wall by more than the pressure does. Control: by less, or the other
    way."""
    failed = lowfi.run(SCENE, compliance=walls(-1.5), numerics=Numerics(modes=0))
    assert failed.status == "diverged"
    assert "under friction of 0.2 the wall of pad face" in failed.message
    assert "yields against its load: a smaller coefficient has a solution" in failed.message
    for drag in (-0.5, 0.5):
        run = lowfi.run(SCENE, compliance=walls(drag), numerics=Numerics(modes=0))
        assert run.status == "exited" and "yields" not in run.message
