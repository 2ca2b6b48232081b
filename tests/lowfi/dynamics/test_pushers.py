"""Springs push a payload of the surrogate: strokes, tables and steps. Speeds are in ``tests.mechanics``."""

import numpy as np
import pytest

from tests.exact.spring import end_of_stroke
from tests.lowfi.support import CENTRED, IMMOVABLE, numerics, scene
from tests.pushed import (
    SPRING,
)
from tipoff import lowfi
from tipoff.lowfi.single_run import SingleRun

MASS = 9.9
INERTIA = {"xx": 0.066, "yy": 0.134, "zz": 0.128, "xy": 0.004, "xz": -0.002}
TIGHT = numerics(1e-10)


def pushed(thrust: dict, duration: float = 0.02, **tables):
    """A payload without contact that springs push from a platform; by default it does not move."""
    neutral = {"platform": IMMOVABLE, "thrust_offset": CENTRED}
    return scene(duration, duration / 100, MASS, INERTIA, thrust=thrust, **neutral | tables)


def last(run) -> tuple[float, float]:
    """Speeds (m/s) of payload and platform along X at the end."""
    assert run.status == "time_limit", run.message
    return run.velocity[-1, 0], run.platform_velocity[-1, 0]


@pytest.mark.case("O61")
def test_the_stroke_lasts_part_of_a_quarter_period():
    """Speeds are a w sin(w t) up to the end of the stroke, whose time is exact to 1e-9, and
    constant after it."""
    exact = end_of_stroke(2e4, 2e5, 0.02, (MASS, np.inf))
    asked, length = pushed(SPRING), []
    for duration in (exact.time, exact.time + 1e-3):
        shorter = asked.replace({"duration": duration, "output": {"interval": duration / 7}})
        run = lowfi.run(shorter, "springs", numerics=TIGHT)
        w, amplitude = np.sqrt(2e5 / MASS), 0.1
        before = np.minimum(run.time, exact.time)
        np.testing.assert_allclose(
            run.velocity[:, 0], amplitude * w * np.sin(w * before), rtol=1e-8
        )
        length.append(run.position[-1, 0])
    assert length[0] == pytest.approx(0.02, rel=1e-8)
    assert length[1] - length[0] == pytest.approx(1e-3 * exact.payload, rel=1e-6)
    # Control: the mean force over the whole stroke ends 2 % early.
    mean = np.sqrt(2.0 * 0.02 * MASS / (2e4 - 1e5 * 0.02))
    assert abs(mean / exact.time - 1.0) > 5e-3


def test_each_knot_of_a_table_ends_a_step(tmp_path):
    """The energy is that of the table to rounding of the tolerance, also if steps are longer than
    the way between two points."""
    path = tmp_path / "push.csv"
    path.write_text("travel [mm],force [N]\n0,20000\n1,12000\n1.5,18000\n9,5000\n20,9000\n")
    asked = pushed({"kind": "spring", "file": str(path)})
    run = lowfi.run(asked, "springs", numerics=numerics(1e-6))
    energy = asked.thrust.energy()
    assert run.energy[-1, 0] == pytest.approx(energy, rel=1e-12)
    assert last(run)[0] == pytest.approx(np.sqrt(2.0 * energy / MASS), rel=1e-6)


def test_no_step_is_longer_than_a_spring_allows():
    """The bound of the pushers is that of an oscillator with friction."""
    asked = pushed(SPRING | {"friction": 1000.0})
    run = SingleRun(asked, lowfi.Numerics())
    run.begin()
    run.integrate(None)
    cost = run.trajectory().cost
    stiffness, damping = 2e5 / MASS, 1000.0 / 1e-3 / MASS
    bound = 0.5 * damping + np.sqrt(0.25 * damping**2 + stiffness)
    assert cost["dt_limit_s"] == pytest.approx(0.95 / bound, rel=1e-6)
    assert cost["limit_used"] <= 1.0 + 1e-9


def test_a_pusher_that_is_used_up_stays_off():
    """A payload that comes back from beyond the stroke feels no force."""
    back = {"position": {"x": 0.03}, "velocity": {"x": -1.0}}
    run = lowfi.run(pushed(SPRING, initial=back), "springs", numerics=TIGHT)
    assert run.position[-1, 0] == pytest.approx(0.01, rel=1e-12)
    assert (run.energy[:, 0] == 0.0).all()
