"""Tables of runs: bad rows are refused alone, the count closes, and no worker count changes a
bit."""

import numpy as np
import pytest

from tests.lowfi.compliance import reference_compliance
from tests.lowfi.support import PAPER_PAD, RAIL, G, scene
from tipoff import lowfi
from tipoff.faults import SceneError
from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.batch import Family
from tipoff.lowfi.numerics import Numerics
from tipoff.scenes import load
from validation.bench.surrogate import varied

LINEAR = {"law": "linear", "clearance": 1e-5, "stiffness": 7e7, "damping": 0.0}
STICKS = {
    "law": "sticking",
    "static": 0.3,
    "dynamic": 0.3,
    "stiffness": 1e7,
    "damping": 1e4,
}

HEAVY = {"gravity.x": -0.36, "payload.mass": 22.0}
ROWS = [{"thrust_offset.misalignment.radial": f"{angle} deg"} for angle in (5, 25, 45, 65)]


@pytest.mark.case("X19")
def test_bad_rows_are_refused_alone():
    rows = [
        ROWS[0],
        {"payload.mass": -1.0},
        {"contact.clearence": 1e-4},
        {"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0},
        ROWS[1],
    ]
    found = lowfi.run_many(load("clamped"), rows, "springs", workers=2)
    assert found.status.values.tolist() == ["exited", "refused", "refused", "diverged", "exited"]
    assert found.attrs == {"modes": 0, "asked": 5, "ok": 2, "refused": 2, "failed": 1}
    assert "payload.mass" in found.message.values[1] and "clearence" in found.message.values[2]
    assert np.isfinite(found.rate.values[[0, 4]]).all() and np.isnan(found.rate.values[1:4]).all()


@pytest.mark.case("X20")
def test_same_bits_for_any_worker_count():
    one, three = (
        lowfi.run_many(load("sensitive"), ROWS, "springs", workers=count) for count in (1, 3)
    )
    for name in ("rate", "velocity", "exit_time", "steps"):
        assert np.array_equal(one[name].values, three[name].values)


NUMBERS = [
    *varied(6),
    {"contact.clearance": "0.1 mm"},
    {"thrust.peak": "5 kN"},
    {"duration": "30 ms"},
    {"initial.position.y": 0.26e-3},
    {"output.interval": "0.2 ms"},
    {"thrust.peak": 20.0},
]
# Each of these has kernels of its own.
TABLES = [
    {"thrust_offset": "absent"},
    {"platform": "absent", "payload.mass": 8.0},
    {"friction": "absent"},
    {"contact": "absent"},
    {"gravity.z": -9.80665},
]


@pytest.mark.parametrize(
    "rows", [NUMBERS, pytest.param([*NUMBERS[:2], *TABLES], marks=pytest.mark.slow)]
)
def test_same_bits_as_single_runs(rows):
    """Varied numbers, text with units, other thrust, time that ends early, pads pressed at
    ignition, a payload that hardly moves, tables that are present or absent: on every path of the
    ensemble the results are those of ``run``."""
    base = load("clamped")
    found = lowfi.run_many(base, rows, "springs", workers=2)
    for index, row in enumerate(rows):
        alone = lowfi.run(base.replace(row), "springs")
        case = found.isel(case=index)
        assert (str(case.status.values), str(case.message.values), int(case.steps)) == (
            alone.status,
            alone.message,
            alone.cost["steps"],
        )
        for name in columns.UNITS:
            expected = getattr(alone.outcome, name)
            assert np.array_equal(
                case[name].values,
                np.nan * case[name].values if expected is None else expected,
                equal_nan=True,
            ), (row, name)


@pytest.mark.parametrize(
    "thrust, rows",
    [
        # a burnt thrust, and a slope down which the payload slides late
        ({"force": 0.0, "duration": 1e-3}, [{"gravity.x": pull} for pull in (0.0, 0.1, 0.05)]),
        # friction stops a payload that would be faster than 10 mm/s; a heavier one is as slow without
        ({"force": 84.0, "duration": 2.4e-3}, [{"payload.mass": mass} for mass in (20.0, 22.0)]),
        ({"force": 84.0, "duration": 2.4e-3}, [{"payload.mass": mass} for mass in (22.0, 20.0)]),
    ],
)
def test_every_case_is_jammed_by_its_own_limits(thrust, rows):
    """The time from which a slow payload is jammed depends on its mass and on the slope, even if the
    thrust of all cases is the same."""
    rail = RAIL | {"start": -0.2, "end": 0.02}
    thrust = {"kind": "constant", "start": 0.0} | thrust
    rough = {"static": 0.2, "dynamic": 0.2, "static_speed": 0.01, "dynamic_speed": 0.02}
    base = scene(2.0, 1e-3, contact=PAPER_PAD, rail=rail, thrust=thrust, gravity={"z": -0.01})
    base = base.replace({"friction": rough if "payload.mass" in rows[0] else None} | rows[0])
    found = lowfi.run_many(base, rows, "springs")
    alone = [lowfi.run(base.replace(row), "springs").status for row in rows]
    assert found.status.values.tolist() == alone and len(set(alone)) == 2 and "jammed" in alone


OWN_CONTACT = [
    {"contact.clearance": 1e-5 * (1 + number), "friction.static": mu, "friction.dynamic": 0.8 * mu}
    for number, mu in enumerate((0.05, 0.2, 0.5))
]
# A payload under its weight that leaves a short rail.
STICKING = scene(
    0.06,
    0.01,
    rail=RAIL | {"start": -0.2, "end": 0.2},
    thrust={"kind": "constant", "force": 2e4, "duration": 0.03},
    gravity={"z": -G},
    contact=LINEAR,
    friction=STICKS,
)


@pytest.mark.parametrize(
    "base, model",
    [
        (load("clamped"), "springs"),
        (load("clamped"), "compliant"),
        (STICKING, "springs"),
    ],
    ids=["springs", "compliant", "sticking"],
)
def test_cases_with_their_own_clearance_and_friction_are_one_call_of_the_kernel(base, model):
    """One call takes a third of the time of many. Each case has the bits of a single run."""
    none, rail = Numerics(modes=0), reference_compliance() if model == "compliant" else None
    assert len(Family(base, None, none, rail).kernels(OWN_CONTACT)) == 1
    found = lowfi.run_many(base, OWN_CONTACT, model, compliance=rail, numerics=none)
    rates = found.rate.values
    for row, rate in zip(OWN_CONTACT, rates):
        alone = lowfi.run(base.replace(row), model, compliance=rail, numerics=none)
        assert np.array_equal(rate, alone.outcome.rate)
    assert len(np.unique(rates, axis=0)) == len(rates)


def test_refused_rows_have_the_reason_of_replace():
    base = load("clamped")
    rows = [
        {"thrust_offset.misalignment.axial": value, "mass_offset.eccentricity.axial": radius}
        for value, radius in (
            (1e-3, 1e-4),
            (2e-3, 1e-4),
            (float("nan"), 1e-4),
            ("1 mm", -1.0),
            (1e-3, 2e-4),
        )
    ]
    found = lowfi.run_many(base, rows, "springs")
    assert found.status.values.tolist() == ["exited", "exited", "refused", "refused", "exited"]
    for index in (2, 3):
        with pytest.raises(SceneError) as refused:
            base.replace(rows[index])
        assert found.message.values[index] == str(refused.value)
    assert np.array_equal(
        found.rate.values[4], lowfi.run(base.replace(rows[4]), "springs").outcome.rate
    )


def test_an_empty_table_is_an_empty_result():
    found = lowfi.run_many(load("clamped"), [], "springs")
    assert found.sizes["case"] == 0 and found.attrs["asked"] == 0
