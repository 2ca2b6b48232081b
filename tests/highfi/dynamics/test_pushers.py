"""Springs push a payload of the reference: step limit and checkpoint. Speeds are in ``tests.mechanics``."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, parts
from tests.pushed import SPRING, pushed, springs
from tipoff import highfi
from tipoff.highfi.dynamics.step_limit import of_pushers


def test_the_step_limit_includes_the_springs():
    """The bound is not below the largest eigenvalue of springs on a rigid payload, nor twice it for
    one spring; and the limit of a run falls with it."""
    asked = pushed(SPRING | {"friction": 1000.0}, 0.01)
    system, stepping, _ = parts(asked)
    body, point = system.model.payload, np.array([-0.1, 0.0, 0.0])
    lever = np.cross(point, [1.0, 0.0, 0.0])
    exact = 2e5 * (1.0 / body.mass + lever @ body.inverse_inertia @ lever)
    bound = of_pushers(system)
    assert exact <= bound.stiffness <= 2e5 * (1.0 / body.mass + 0.01 / 0.06)
    assert bound.damping == pytest.approx(bound.stiffness * 1000.0 / 2e5 / 1e-3, rel=1e-12)
    _, stiffer, _ = parts(pushed(SPRING | {"preload": 1e15, "rate": 1e15}, 0.01))
    assert stiffer.dt_limit_s < 0.5 * stepping.dt_limit_s


def test_a_run_continues_to_the_same_bits(tmp_path):
    """The segments, travels and forces of the pushers are in a checkpoint."""
    asked, kept = pushed(springs(), 0.006), tmp_path / "run.npz"
    whole = highfi.run(asked, COARSE)
    interrupted = {"count": 0}

    def stop(loop):
        interrupted["count"] += 1
        if interrupted["count"] == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        highfi.run(asked, COARSE, checkpoint=kept, checkpoint_every=0.0, observer=stop)
    resumed = highfi.run(asked, COARSE, checkpoint=kept, resume=True)
    np.testing.assert_array_equal(resumed.rate, whole.rate)
    np.testing.assert_array_equal(resumed.energy, whole.energy)
