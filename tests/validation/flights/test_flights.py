"""Records of launches: the reduction finds what was put in, and the kept comparison is that of the page."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from tests.docs import pages
from tipoff.faults import SceneError
from tipoff.workspace import machine
from validation.flights import compare, launchers, page, record
from validation.flights.launchers import GRAVITY, LAUNCHERS, PSAS

STORED = json.loads((pages.ROOT / "tests/measurements/flights.json").read_text(encoding="utf-8"))
KEPT = STORED["flights"]
FORCE, BIAS, EXIT_RATE = 95.0, (0.5, -0.3, 0.2), (9.0, 1.5, -0.5)  # m/s2, deg/s, deg/s
INTERVAL = 1.0 / 819.2  # s


def made(noise: float = 0.3, seed: int = 3) -> np.ndarray:
    """A record of constant thrust from 0 s on, with a roll of 20 deg/s on the rail: twelve
    periods in the 0.29 s whose spectrum is taken, so that it is in one line of the spectrum."""
    time = np.arange(-0.6, 0.6, INTERVAL)
    rates = np.where(
        (time > 0.312)[:, None],
        EXIT_RATE,
        np.where(time > 0.0, 20.0 * np.sin(2.0 * np.pi * (12.0 / 0.29) * time), 0.0)[:, None]
        * [1, 0, 0],
    )
    generator = np.random.default_rng(seed)
    rates = rates + BIAS + noise * generator.standard_normal((time.size, 3))
    force = np.column_stack([np.where(time >= 0.0, FORCE, GRAVITY), 0.0 * time, 0.0 * time])
    return np.column_stack([time, force, rates])


def test_the_reduction_finds_what_was_put_in():
    found = record.reduced(PSAS, made())
    np.testing.assert_allclose(np.degrees(found.bias), BIAS, atol=4 * 0.3 / np.sqrt(450))
    at = 0.32
    speed, way = (FORCE - GRAVITY) * at, 0.5 * (FORCE - GRAVITY) * at**2
    assert found.at_exit(found.speed)[0] == pytest.approx(speed, rel=0.01)
    assert found.at_exit(found.way)[0] == pytest.approx(way, rel=0.02)
    stated = compare.measured(found)
    for axis, name in enumerate("xyz"):
        rate, spread, _ = stated[f"rate {name} at the exit, deg/s"]
        assert abs(rate - EXIT_RATE[axis]) < 4.0 * spread
    thrust = record.thrust(found)
    inner = (thrust[:, 0] > 0.02) & (thrust[:, 0] < 0.4)
    np.testing.assert_allclose(thrust[inner, 1], FORCE * PSAS.mass, rtol=1e-6)


def test_rattling_is_in_its_band():
    found = compare.quantities(
        record.reduced(PSAS, made(noise=0.0)), record.reduced(PSAS, made(0.0)).rate
    )
    inside = found["rms of roll rate, 25 to 60 Hz, deg/s"]
    assert inside == pytest.approx(20.0 / np.sqrt(2.0), rel=0.05)
    # Control: the other bands have less than a tenth of it
    for band in ("60 to 150", "150 to 400"):
        assert found[f"rms of roll rate, {band} Hz, deg/s"] < 0.1 * inside
    assert found["rms of lateral rate, 25 to 60 Hz, deg/s"] < 1e-6


def test_a_record_that_is_missing_is_refused(tmp_path):
    with pytest.raises(SceneError, match="psas_l12"):
        record.read(tmp_path, PSAS)
    (tmp_path / "psas_l12.csv").write_text("time_s\n1\n2\n", encoding="utf-8")
    with pytest.raises(SceneError, match="seven columns"):
        record.read(tmp_path, PSAS)


@pytest.mark.parametrize("launcher", LAUNCHERS, ids=lambda launcher: launcher.name)
def test_scenes_have_the_published_places(launcher, tmp_path):
    curve = tmp_path / "thrust.csv"
    curve.write_text("time_s,force_N\n0,0\n0.01,2000\n0.9,2000\n0.95,0\n", encoding="utf-8")
    for number, variant in enumerate(launcher.variants):
        made = launchers.scene(launcher, variant, curve, tmp_path, number)
        assert made.rail.end - made.rail.start == pytest.approx(launcher.rail)
        assert len(made.pads) == 12
        assert {pad.position[0] for pad in made.pads} == {variant.rear, variant.front}
        for draw in launchers.draws(3, number):
            changed = made.replace(launchers.changes(launcher, draw))
            assert 0.1e-3 <= changed.contact.clearance <= 1e-3
            assert changed.payload.mass == pytest.approx(launcher.mass, rel=0.0151)


@pytest.mark.parametrize("kept", KEPT, ids=lambda kept: kept["flight"])
def test_the_page_has_every_comparison(kept):
    text = (pages.ROOT / "docs/measured_launches.md").read_text(encoding="utf-8")
    assert page.table(kept) in text
    assert f"{machine.stated(STORED['state'])};" in text


@pytest.mark.parametrize("kept", KEPT, ids=lambda kept: kept["flight"])
def test_verdicts_follow_from_the_ranges(kept):
    for row in kept["rows"]:
        for model, ends in row["ranges"].items():
            assert row["inside"][model] == (ends[0] <= row["measured"] <= ends[2])


@pytest.mark.parametrize("kept", KEPT, ids=lambda kept: kept["flight"])
def test_kept_values_are_those_of_the_record(kept):
    folder = os.environ.get(record.ROOT)
    if folder is None:
        pytest.skip(f"the records are not part of the project; {record.ROOT} names their folder")
    launcher = next(one for one in LAUNCHERS if one.name == kept["flight"])
    found = compare.measured(record.read(Path(folder), launcher))
    assert len(found) == len(kept["rows"])
    for row, stated in zip(kept["rows"], found.values(), strict=True):
        assert row["measured"] == pytest.approx(stated.value, rel=1e-9)
        if row["uncertainty"] is not None:
            assert row["uncertainty"] == pytest.approx(stated.uncertainty, rel=1e-5)
