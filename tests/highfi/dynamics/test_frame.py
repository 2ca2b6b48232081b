"""The moving frame: inertial loads on the rail, and momenta with contact and friction but nothing
from outside."""

import numpy as np
import pytest

from tests.highfi.support import (
    CENTRED,
    COARSE,
    NO_THRUST,
    bar_mesh,
    loop_on,
    spinning_bar_stretch,
    stopped,
    tiny,
)
from tipoff import highfi
from tipoff.highfi.dynamics import observe
from tipoff.scenes import parse


@pytest.mark.case("O12")
def test_bar_turning_about_its_root_stretches():
    """rho w^2 L^3 / (3 E) = 1.1240 um for an aluminium bar of 0.6 m at 20 rad/s; started suddenly
    it swings about that."""
    density, modulus, length, rate = 2810.0, 72e9, 0.6, 20.0
    scene = parse(
        {
            "name": "bar",
            "duration": 9.483e-3,
            "output": {"interval": 1e-5},
            "pads": [{"position": [0.0, 5.0, 0.0], "normals": ["+y"]}],
            "payload": {"mass": 1.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}},
            "platform": {"mass": 1e6, "inertia": {"xx": 1e6, "yy": 1e6, "zz": 1e6}},
            "rail": {
                "start": 0.0,
                "end": length,
                "material": {"density": density, "youngs_modulus": modulus, "poisson_ratio": 0.33},
            },
            "thrust": {"kind": "constant", "force": 0.0, "duration": 1e-3},
            "initial": {"platform_rate": {"z": rate}},
        },
        bare_numbers_are_si=True,
    )
    loop = loop_on(scene, bar_mesh(length, 0.02, 30))
    tip = loop.setup.system.number[loop.setup.system.mesh.points[:, 0] == length]
    loop.begin()
    stretch = [0.0]
    for _ in range(948):  # twenty periods 4 L / c of the first axial mode
        loop.advance_one_sample()
        stretch.append(loop.stepper.state.displacement[tip, 0].mean())
    assert not loop.recorded.message
    assert np.mean(stretch) == pytest.approx(
        spinning_bar_stretch(density, rate, length, modulus), rel=0.01
    )


@pytest.mark.case("O32")
@pytest.mark.parametrize(
    "duration, steps", [("12 ms", 2e4), pytest.param("60 ms", 1e5, marks=pytest.mark.slow)]
)
def test_momenta_without_outside_load(duration, steps):
    """Payload, four elastic rails and free platform through contact and friction: p and L stay
    fixed over so many steps."""
    scene = tiny(
        thrust=NO_THRUST | {"arm": 0.1},
        thrust_offset=CENTRED,
        duration=duration,
        initial={
            "velocity": {"x": 2.0, "y": 0.1, "z": 0.03},
            "rate": {"x": 0.5, "y": 0.1, "z": -0.2},
        },
    )
    found = highfi.run(scene, COARSE)
    assert found.cost["steps"] >= steps
    touched = np.abs(found.pad_force).max(axis=(0, 2)) > 0.0
    assert touched.sum() >= 4 and found.energy[-1, 6] > 0.0
    assert found.checks["linear_momentum_error"] <= 1e-12
    assert found.checks["angular_momentum_error"] <= 1e-8


@pytest.mark.parametrize("rate", [(0.0, 0.0, 1.0), (3.0, 1.0, -2.0)])
def test_a_payload_at_rest_on_a_turning_platform(rate):
    """The momenta of rails and platform cancel, and the payload has none: what is left is rounding and
    no error. Control: a lost impulse of a billionth of the momenta of all nodes is seen."""
    scene = tiny(
        thrust=NO_THRUST | {"arm": 0.1},
        thrust_offset=CENTRED,
        duration="0.3 ms",
        initial={"platform_rate": dict(zip("xyz", rate))},
    )
    loop = stopped(2, scene)
    found = loop.trajectory({}, COARSE)
    assert not found.message and found.checks["linear_momentum_error"] <= 1e-12
    loop.recorded.rows[-1][observe.LINEAR] += 1e-9 * loop.recorded.rows[-1][observe.SIZES]
    assert "linear momentum" in loop.trajectory({}, COARSE).message
