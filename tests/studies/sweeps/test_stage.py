"""Sweeps of the three errors: the exact rates of a free payload, and the whole stage with contact
on a small scene."""

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from tipoff.mechanics.laws import thrust
from tipoff.scenes import load, moments
from tipoff.scenes.effects import thrust_offset
from tipoff.studies.cli import app
from tipoff.studies.populations import answers, population
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.sensitivity.options import SensitivityOptions
from tipoff.studies.sweeps import burnout, factors, sides
from tipoff.studies.sweeps import page as sections
from tipoff.studies.sweeps import stage as sweeps
from tipoff.workspace.settings import Settings
from tipoff.workspace.study import Study, read

# Of the reference scene, whose pulse begins three widths before its peak.
IMPULSE, ARM = (
    6000.0 * 4e-3 * np.sqrt(2.0 * np.pi) * 0.5 * (1.0 + math.erf(3.0 / math.sqrt(2.0))),
    0.1,
)
TENSOR = np.array([[0.066, 0.004, -0.002], [0.004, 0.134, 0.0], [-0.002, 0.0, 0.128]])


def by_hand(name: str, size: float, angle: float) -> np.ndarray:
    """Rate (deg/s) of the free reference payload: inverse tensor times r x J, from the numbers of
    its file."""
    sine, cosine = np.sin(angle), np.cos(angle)
    if name == "misalignment":
        tilt = np.sin(np.radians(size))
        moment = np.cross([-ARM, 0.0, 0.0], [np.cos(np.radians(size)), tilt * cosine, tilt * sine])
    else:
        sign = 1.0 if name == "thrust_eccentricity" else -1.0  # the mass centre moves the other way
        moment = np.cross(
            [-ARM, sign * 1e-3 * size * sine, sign * 1e-3 * size * cosine], [1.0, 0.0, 0.0]
        )
    return np.degrees(np.linalg.solve(TENSOR, IMPULSE * moment))


def test_without_contact_rates_are_the_moment_impulse_over_the_inertia(tmp_path, monkeypatch):
    """Rates in proportion to every factor, without a plateau, for both thrusts. Allowed errors:
    0.2 % of integration, and the gyroscopic moment -w x I w, which the closed form leaves out, at its
    last value."""
    monkeypatch.setattr(sweeps.drawing, "figures", lambda _: [])
    study = Study(
        load("reference").replace({"contact": None, "friction": None}),
        tmp_path / "reference",
        Settings(workers=1),
    )
    found = sweeps.run(study, SensitivityOptions(sweep=8)).result
    for launch in found.launches:
        assert launch.cases == {"asked": 240, "ok": 240, "refused": 0, "failed": 0}
        assert launch.not_settled == 0
        for factor in launch.factors:
            assert factor.departs_from_free_at is None and factor.sides is None
            exact = np.array(
                [
                    [by_hand(factor.name, size, angle) for angle in factors.angles(8)]
                    for size in factor.sizes
                ]
            )
            turning = np.radians(exact)
            speeding = np.linalg.solve(TENSOR, np.cross(turning, turning @ TENSOR)[..., None])[
                ..., 0
            ]
            gyroscopic = np.degrees(speeding) * (launch.exit_s + 3e-3)
            for axis, name in enumerate(item.name for item in answers.RATES):
                within = 2e-3 * np.linalg.norm(exact, axis=2) + abs(gyroscopic[..., axis])
                assert (abs(np.array(factor.values[name]) - exact[..., axis]) <= within).all()
                allowed = within.max()
                assert allowed < 0.02 * abs(exact).max()
                assert factor.free[name] == pytest.approx(
                    abs(exact[..., axis]).max(axis=1), rel=1e-5
                )
                bent = factor.growth[name]
                # Roll has a gyroscopic share that grows with the square of the size: 1.5 % of it,
                # so it may bend a little.
                assert bent.verdict.startswith(
                    "no plateau" if axis == 0 else "no plateau, in proportion"
                )
                assert bent.plateau_share == 0.0
                assert bent.slope_before == pytest.approx(
                    abs(exact[-1, :, axis]).max(), abs=allowed
                )
    assert found.launches[0].share_after_exit == 0.0 and found.launches[1].share_after_exit > 0.15


@pytest.mark.parametrize(
    "thrust, share",
    [
        ({"kind": "gaussian", "peak": "0 N", "width": "1 ms", "centre": "3 ms"}, 0.0),
        ({"kind": "gaussian", "peak": "6 kN", "width": "1 ms", "centre": "3 ms"}, 0.0),
        (
            {
                "kind": "gaussians",
                "components": [
                    {"peak": "6 kN", "width": "1 ms", "centre": "8 ms"},
                    {"peak": "-6 kN", "width": "1 ms", "centre": "500 ms"},
                ],
            },
            1.0,
        ),
    ],
    ids=["no thrust", "a push", "a push on the rail and a pull after it"],
)
def test_the_share_of_the_impulse_after_the_exit(thrust, share):
    """A payload that is in motion at ignition leaves without an impulse too."""
    free = load("reference").replace(
        {
            "contact": None,
            "friction": None,
            "thrust_offset": None,
            "duration": None,
            "initial": {"velocity": {"x": "5 m/s"}},
            "thrust": thrust | {"arm": "0.1 m"},
        }
    )
    found = burnout.exit_of(Surrogate(free, None, None))
    assert found.share_after == pytest.approx(share, abs=1e-9)


def test_a_stretched_thrust_keeps_its_impulse():
    model = Surrogate(
        load("reference").replace({"contact": None, "friction": None, "thrust_offset": None}),
        None,
        None,
    )
    stretch, other, leaves = burnout.other_way(model)
    assert (
        stretch == 8.0 and leaves.share_after > 0.15 and burnout.exit_of(model).share_after == 0.0
    )
    assert other.scene.thrust.describe(other.scene.duration)[
        "impulse_delivered_Ns"
    ] == pytest.approx(IMPULSE, rel=1e-9)
    back = burnout.other_way(other)
    assert back[0] <= 0.5 and back[2].share_after <= 1e-3
    constant = load("reference").replace(
        {"thrust": {"kind": "constant", "force": 5000.0, "duration": 0.012}}
    )
    changed = constant.replace(burnout.stretched(constant, 4.0))
    assert (changed.thrust.requested(), changed.duration) == pytest.approx(
        (60.0, 4.0 * constant.duration)
    )


def test_sides_of_forces():
    time, force = np.linspace(0.0, 1.0, 101), np.zeros((101, 3))
    assert sides.touched(time, force) == (sides.NONE, sides.NONE)
    force[10:20, 2], force[30:90, 0] = 5.0, 1.0
    assert sides.touched(time, force) == (2, 0)
    force[10:20, 1] = 6.0
    assert sides.touched(time, force)[0] == 1
    walls = np.array([["a", "a", "b", "b"]] * 2)
    rate = np.zeros((2, 4, 3))
    rate[:, 2:, 1] = 3.0
    assert (
        sides.jumps(walls, rate) == (3.0, 0.0)
        and sides.jumps(np.full((2, 4), "a"), rate)[0] is None
    )


def test_moment_impulses_of_many_cases_are_those_of_their_scenes():
    scene, random = load("reference"), np.random.default_rng(1)
    inputs = {
        f"{table}.{name}": random.uniform(0.0, most, 20)
        for table, size in (
            ("thrust_offset.misalignment", 0.1),
            ("thrust_offset.eccentricity", 1e-3),
            ("mass_offset.eccentricity", 1e-3),
        )
        for name, most in (("axial", size), ("radial", 6.0))
    }
    inputs |= {
        "thrust.arm": random.uniform(0.05, 0.2, 20),
        "thrust.peak": random.uniform(1e3, 9e3, 20),
    }
    expected = []
    for values in zip(*inputs.values()):
        each = scene.replace(dict(zip(inputs, map(float, values))))
        record = thrust_offset.record(each.thrust_offset, each.mass_offset, each.thrust.arm)
        expected.append(
            thrust.impulse(each.thrust.record(), each.duration)
            * np.cross(record.arm, record.direction)
        )
    impulse = (
        thrust.impulse(scene.thrust.record(), scene.duration)
        * inputs["thrust.peak"]
        / scene.thrust.peak
    )
    assert moments.moment_impulses(scene, inputs, impulse) == pytest.approx(
        np.array(expected), rel=1e-12, abs=1e-14
    )


def test_the_command_with_contact(tmp_path, monkeypatch):
    """One factor of the tiny scene, whose constants replace a fit: the files, and that a second run
    is not made."""
    for module in (sweeps, factors):
        monkeypatch.setattr(module, "FACTORS", factors.FACTORS[1:2])
    monkeypatch.setattr(
        population, "surrogate", lambda study, *_: Surrogate(study.scene, None, None)
    )
    arguments = [
        "sensitivity",
        "--scene",
        "tiny",
        "--sweep",
        "8",
        "--workers",
        "1",
        "--out",
        str(tmp_path),
    ]
    result = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert result.exit_code == 0
    kept = read(tmp_path / "tiny" / "sweeps.json")
    found = sweeps.STAGE.read(kept)
    given = found.launches[0]
    assert (
        given.faces[:2] == ("rear -y", "rear -z")
        and given.faces[-1] == "front +z"
        and len(given.faces) == 16
    )
    (factor,) = given.factors
    assert factor.departs_from_free_at is not None and factor.growth["rate_deg_s"].verdict
    for item in answers.ALL:
        cases = np.array(factor.values[item.name], dtype=float)
        assert cases.shape == (10, 8) and factor.largest[item.name] == tuple(
            np.nanmax(abs(cases), axis=1)
        )
        row = next(
            row
            for row in sections.table_of_largest(given).rows
            if row[0] == f"{item.label} ({item.unit})"
        )
        assert row[1] == np.nanmax(abs(cases))
    # Thrust above the mass centre turns the front down and the rear up; at 90 deg, alpha from +z
    # towards +y, it does so towards +y.
    seen = factor.sides.first
    assert given.faces[seen[4][0]] in ("rear +z", "front -z") and given.faces[seen[4][2]] in (
        "rear +y",
        "front -y",
    )
    assert {path.name for path in (tmp_path / "tiny" / "figures").iterdir()} == {
        f"{name}.{kind}"
        for name in ("sweep-growth", "sweep-thrust_eccentricity", "map-thrust_eccentricity")
        for kind in ("png", "svg")
    }
    monkeypatch.setattr(population, "surrogate", lambda *_: pytest.fail("made again"))
    again = CliRunner().invoke(app, [*arguments, "--json"], catch_exceptions=False)
    assert json.loads(again.stdout) == kept
