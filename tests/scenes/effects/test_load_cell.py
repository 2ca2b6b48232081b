"""The reading of a load cell before ignition: found, said, and taken out only on request."""

import re

import numpy as np
import pytest

from tests.scenes.support import refused, small
from tipoff.scenes import parse, plausibility
from tipoff.scenes.shown import facts

TIME = np.arange(0.0, 3.0, 1e-3)
IGNITION, END, PEAK = 1.2, 2.2, 300.0
BURN = PEAK * np.sin(np.pi * np.clip((TIME - IGNITION) / (END - IGNITION), 0.0, 1.0))
IMPULSE = PEAK * (END - IGNITION) * 2.0 / np.pi  # of a half sine
NOISE = 0.4


def raw(folder, first, last, noise=NOISE, **keys):
    """A scene with the log of a load cell whose zero drifts from ``first`` to ``last``."""
    force = BURN + first + (last - first) * TIME / TIME[-1]
    force = force + noise * np.random.default_rng(8).standard_normal(TIME.size)
    rows = "".join(f"{1e3 * t:.0f};{f:.4f}\n" for t, f in zip(TIME, force)).replace(".", ",")
    (folder / "firing.csv").write_text("# stand 2\nTime [ms];Thrust [N]\n" + rows)
    table = {"kind": "measured", "file": str(folder / "firing.csv")} | keys
    return small(thrust=table, duration="3.5 s")


def test_the_reading_before_ignition_is_said_and_kept(tmp_path):
    """Also where the scene is printed. Control: the impulse has the 12 N s of the offset."""
    scene = parse(raw(tmp_path, 4.0, 4.0))
    thrust = scene.thrust
    assert "columns Time [ms] and Thrust [N]; reading before ignition" in facts(scene)["thrust"]
    said = re.search(
        r"reading before ignition at (\S+) s (\S+) N, noise (\S+) N, kept",
        thrust.describe(3.5)["text"],
    )
    at, level, noise = map(float, said.groups())
    # 3 standard deviations of the noise are reached after 1.3 ms
    assert at == pytest.approx(IGNITION + 2e-3, abs=4e-3)
    assert level == pytest.approx(4.0, abs=4.0 * 1.2533 * NOISE / np.sqrt(600.0))
    assert noise == pytest.approx(NOISE, rel=0.15)
    assert thrust.requested() == pytest.approx(IMPULSE + 12.0, rel=2e-3)


@pytest.mark.case("X28")
@pytest.mark.parametrize("first, last", [(4.0, 4.0), (-6.0, 2.0)])
def test_an_offset_is_taken_out_on_request(tmp_path, first, last):
    """The impulse of the half sine is left, and nothing acts before ignition. Control: without the
    key a warning names it, and the impulse is off."""
    scene = parse(raw(tmp_path, first, last, remove_offset=True))
    thrust = scene.thrust
    assert thrust.requested() == pytest.approx(IMPULSE, rel=2e-3)
    time, force = thrust.curve()
    assert (force[time < IGNITION - 2e-3] == 0.0).all() and (force[time > 1.21] != 0.0).all()
    assert "N, subtracted" in thrust.usage()
    assert not [words for words in plausibility.warnings(scene) if "thrust.baseline" in words]
    kept = parse(raw(tmp_path, first, last))
    assert abs(kept.thrust.requested() / IMPULSE - 1.0) > 0.02
    (said,) = [words for words in plausibility.warnings(kept) if "thrust.baseline" in words]
    assert said.endswith("or thrust.remove_offset = true")
    assert kept.hash != scene.hash


def test_an_ignition_shifts_the_log(tmp_path):
    scene = parse(raw(tmp_path, 4.0, 4.0, remove_offset=True, ignition="1.2 s"))
    time, force = scene.thrust.curve()
    assert time[0] == 0.0 and time[-1] == pytest.approx(TIME[-1] - 1.2)
    assert scene.thrust.requested() == pytest.approx(IMPULSE, rel=2e-3)
    kept = parse(raw(tmp_path, 4.0, 4.0, ignition="1.2 s"))
    (said,) = [words for words in plausibility.warnings(kept) if "thrust.baseline" in words]
    level = float(said.partition("zero: ")[2].partition(" N")[0])  # of the log before ignition
    assert level == pytest.approx(4.0, abs=4.0 * 1.2533 * NOISE / np.sqrt(600.0))
    assert force[np.argmin(np.abs(time - 0.5))] == pytest.approx(PEAK, abs=4.0 * NOISE)


def test_an_instant_between_two_points_is_interpolated(tmp_path):
    (tmp_path / "a.csv").write_text("time_s,force_N\n-1,2\n1,6\n3,0\n")
    table = {"kind": "measured", "file": str(tmp_path / "a.csv"), "ignition": "-0.5 s"}
    time, force = parse(small(thrust=table, duration="4 s")).thrust.curve()
    assert time.tolist() == [0.0, 1.5, 3.5] and force.tolist() == [3.0, 6.0, 0.0]


def test_a_quiet_record_says_nothing(tmp_path):
    thrust = parse(raw(tmp_path, 0.0, 0.0, noise=0.0)).thrust
    assert "reading" not in thrust.usage()


def test_what_cannot_be_taken_out_is_refused(tmp_path):
    both = raw(tmp_path, 4.0, 4.0, remove_offset=True, baseline=["4 N", "4 N"])
    (fault,) = refused(both)
    assert fault.key == "thrust.remove_offset" and fault.expected == "one or the other"
