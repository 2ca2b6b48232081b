"""Sensitivity of the cases of an ensemble: the bits of single runs made by hand, conditions that are
known to be sensitive, and stores that continue."""

import errno
from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import reference_compliance
from tests.scenes.test_calibration import CALIBRATION
from tipoff import cache, lowfi
from tipoff.lowfi.ensemble import many, twins
from tipoff.lowfi.ensemble import store as stores
from tipoff.scenes import load
from validation.bench.surrogate import varied

REFERENCE = load("clamped")
CLEARANCE, TOLERANCE = "rate_change_by_clearance", "rate_change_by_tolerance"
TIGHT = lowfi.Numerics(relative_tolerance=1e-10)
OWN = {"contact.clearance_y": 0.26e-3, "contact.clearance_z": 0.24e-3}


def apart(one, other) -> float:
    """Largest change of a settled rate, rad/s."""
    return np.abs(np.subtract(other.outcome.rate, one.outcome.rate)).max()


def expected(scene, *wider: str, model="springs", **options) -> tuple[float, float]:
    """The changes of one scene from three single runs, where the clearances ``wider`` (names) are
    1 um larger."""
    larger = {f"contact.{name}": getattr(scene.contact, name) + 1e-6 for name in wider}
    nominal, wide, tight = (
        lowfi.run(scene, model, **options),
        lowfi.run(scene.replace(larger), model, **options),
        lowfi.run(scene, model, **options | {"numerics": TIGHT}),
    )
    return apart(nominal, wide), apart(nominal, tight)


@pytest.mark.parametrize(
    "row, wider",
    [
        (varied(1)[0], ["clearance"]),
        ({"contact.clearance": "0.1 mm"}, ["clearance"]),
        (OWN, ["clearance_y", "clearance_z"]),
        ({"contact.clearance_y": 0.26e-3, "thrust.peak": "5 kN"}, ["clearance", "clearance_y"]),
    ],
)
def test_changes_are_those_of_single_runs(row, wider):
    """Also where a row states the clearance, or one of its own along y or z: those in force grow."""
    found = lowfi.run_many(REFERENCE, [{}, row], "springs", sensitivity=True)
    assert found[CLEARANCE].attrs["units"] == found[TOLERANCE].attrs["units"] == "rad/s"
    for case, scene, names in ((0, REFERENCE, ["clearance"]), (1, REFERENCE.replace(row), wider)):
        changes = found[CLEARANCE].values[case], found[TOLERANCE].values[case]
        assert changes == expected(scene, *names) and min(changes) > 0.0
    if row is OWN:  # control: the clearance of the other faces alone moves no wall here
        assert found[CLEARANCE].values[1] > 10.0 * expected(REFERENCE.replace(row), "clearance")[0]


def test_a_calibrated_clearance_grows_too():
    """A calibration of springs replaces the clearance that a row states; the one that is in force
    grows. So does one with an amount added, on compliant contact."""
    fitted = replace(CALIBRATION, constants={"contact.clearance": 0.26e-3})
    rows = [varied(1)[0], {"contact.clearance": 0.2e-3}]
    found = lowfi.run_many(REFERENCE, rows, "springs", calibration=fitted, sensitivity=True)
    for row, change in zip(rows, found[CLEARANCE].values):
        scene = REFERENCE.replace(row).replace(fitted.constants)
        assert change == expected(scene, "clearance")[0] > 0.0
    added = replace(CALIBRATION, constants={}, changes={"contact.clearance": 5e-6})
    pressed = {"compliance": reference_compliance()}
    found = lowfi.run_many(REFERENCE, rows[1:], calibration=added, sensitivity=True, **pressed)
    scene = REFERENCE.replace({"contact.clearance": 0.2e-3 + 5e-6})
    wanted = expected(scene, "clearance", model="compliant", **pressed)
    assert (found[CLEARANCE].values[0], found[TOLERANCE].values[0]) == wanted


@pytest.mark.parametrize("condition, sensitive", [("phi35", False), ("h7", True), ("h8", True)])
def test_known_conditions(condition, sensitive):
    """Control: those that are known to be sensitive move by more than the limit of agreement."""
    found = lowfi.run_many(REFERENCE.condition(condition), [{}], "springs", sensitivity=True)
    assert bool(np.degrees(found[CLEARANCE].values[0]) > 0.1) is sensitive
    assert np.degrees(found[TOLERANCE].values[0]) < 1e-3


def test_cases_that_do_not_settle_have_no_value_and_free_flight_does_not_change():
    rows = [
        {"payload.mass": -1.0},
        {"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0},
        {"duration": "30 ms"},
        {"contact": "absent", "friction": "absent"},
        {},
    ]
    found = lowfi.run_many(REFERENCE, rows, "springs", sensitivity=True)
    assert found.status.values.tolist()[:3] == ["refused", "diverged", "time_limit"]
    for name in (CLEARANCE, TOLERANCE):
        assert np.isnan(found[name].values[:3]).all() and np.isfinite(found[name].values[3:]).all()
    assert found[CLEARANCE].values[3] == 0.0 < found[CLEARANCE].values[4]


def test_a_case_whose_twin_does_not_settle_has_no_value():
    """One of the changes is NaN; it is no small one."""
    rates = np.array([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], [np.nan] * 3])
    other = np.array([[0.1, 0.25, 0.31], [np.nan] * 3, [0.1, 0.2, 0.3]])
    np.testing.assert_allclose(twins.change(rates, other), [0.05, np.nan, np.nan])


def test_time_of_a_case_leaves_its_twins_out(monkeypatch):
    """In a clock that charges each case 1 s, each with more clearance 10 s, each tight one 100 s.
    Nothing else changes."""
    rows, real = varied(3), many.completed

    def charged(family, pieces, workers):
        tight = family.numerics.relative_tolerance < 1e-9
        for cases in real(family, pieces, workers):
            share = 10.0 if family.widening else 100.0 if tight else 1.0
            yield [case._replace(wall_s=share) for case in cases]

    monkeypatch.setattr(many, "completed", charged)
    plain = lowfi.run_many(REFERENCE, rows, "springs")
    found = lowfi.run_many(REFERENCE, rows, "springs", sensitivity=True)
    assert found.wall_s.values.tolist() == [1.0] * 3
    assert found.sensitivity_wall_s.values.tolist() == [110.0] * 3
    assert found.drop_vars([CLEARANCE, TOLERANCE, "sensitivity_wall_s"]).identical(plain)


def test_the_tolerance_is_always_tighter():
    given = [lowfi.Numerics(relative_tolerance=size) for size in (1e-2, 2e-7, 1e-10, 1e-12)]
    tight = [twins.tight(numerics).relative_tolerance for numerics in given]
    np.testing.assert_allclose(tight, [1e-10, 1e-10, 1e-11, 1e-13], rtol=1e-12)


def test_an_unknown_option_is_refused():
    with pytest.raises(TypeError, match="sensitivty"):
        lowfi.run_many(REFERENCE, [], "springs", sensitivty=True)


def test_a_store_is_taken_up_where_its_twins_stopped(tmp_path, monkeypatch):
    """A disk that is full in the second chunk of the first twin: the columns appear when they are
    whole, no chunk is run twice, and the bits are those without a store."""
    xarray = pytest.importorskip("xarray")
    monkeypatch.setattr(stores, "CHUNK", 4)
    rows, real, written = varied(10), cache.write_json, []

    def full(path, value):
        if path.parent.name != "done":
            return real(path, value)
        if len(written) == 4:  # three chunks of the cases, one of their twins
            raise OSError(errno.ENOSPC, "No space left on device")
        written.append(path.relative_to(tmp_path / "store").parts[:-1])
        return real(path, value)

    def run(**options):
        return lowfi.run_many(
            REFERENCE, rows, "springs", store=tmp_path / "store", workers=1, **options
        )

    def opened():
        place = tmp_path / "store" / "cases.zarr"
        return xarray.open_zarr(place, consolidated=False, chunks=None).load()

    monkeypatch.setattr(cache, "write_json", full)
    with pytest.raises(stores.StoreError, match="4 of 10 cases are stored, and the same command"):
        run(sensitivity=True)
    assert CLEARANCE not in opened() and np.isfinite(opened().rate.values).all()
    written.clear()
    monkeypatch.setattr(cache, "write_json", lambda *given: written.append(0) or real(*given))
    found = run(sensitivity=True)
    assert len(written) == 2 + 3
    assert run(sensitivity=True).identical(found) and len(written) == 5
    plain = lowfi.run_many(REFERENCE, rows, "springs", sensitivity=True)
    assert found.identical(plain.drop_vars(["wall_s", "sensitivity_wall_s"]))
    for name in (CLEARANCE, TOLERANCE):
        assert np.array_equal(opened()[name].values, found[name].values)
        assert opened()[name].attrs["units"] == "rad/s"
    assert CLEARANCE not in run()  # not asked for
