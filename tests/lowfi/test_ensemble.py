"""Tables of runs: bad rows are refused alone, the count closes, and no worker count changes a bit."""

import numpy as np

import lowfi
from scenes import load

ROWS = [{"thrust_offset.misalignment.radial": f"{angle} deg"} for angle in (5, 25, 45, 65)]


def test_bad_rows_are_refused_alone():
    rows = [ROWS[0], {"payload.mass": -1.0}, {"contact.clearence": 1e-4}, {"thrust.peak": 1e200, "thrust_offset.misalignment.axial": 0.0}, ROWS[1]]
    found = lowfi.run_many(load("reference"), rows, workers=2)
    assert found.status.values.tolist() == ["exited", "refused", "refused", "diverged", "exited"]
    assert found.attrs == {"asked": 5, "ok": 2, "refused": 2, "failed": 1}
    assert "payload.mass" in found.message.values[1] and "clearence" in found.message.values[2]
    assert np.isfinite(found.rate.values[[0, 4]]).all() and np.isnan(found.rate.values[1:4]).all()


def test_same_bits_for_any_worker_count():
    one, three = (lowfi.run_many(load("sensitive"), ROWS, workers=count) for count in (1, 3))
    for name in ("rate", "velocity", "exit_time", "steps"):
        assert np.array_equal(one[name].values, three[name].values)


def test_curves_keep_their_order():
    base = load("reference")
    found = lowfi.curves([base.replace(row) for row in ROWS], workers=2)
    for row, curve in zip(ROWS, found):
        assert curve.outcome.rate == lowfi.run(base.replace(row)).outcome.rate


def test_an_empty_table_is_an_empty_result():
    found = lowfi.run_many(load("reference"), [])
    assert found.sizes["case"] == 0 and found.attrs["asked"] == 0
