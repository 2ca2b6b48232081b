"""Structural damping of the rail as a scene states it: ratios at two frequencies."""

import math

import pytest

from tests.scenes.support import SMALL, small
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.scenes import load, parse

FREQUENCIES = ["500 Hz", "5 kHz"]


def damped(ratios, frequencies=FREQUENCIES, **tables):
    return small(rail__damping={"ratios": ratios, "frequencies": frequencies}, **tables)


def ratio(damping, frequency):
    """Damping ratio at an angular frequency (rad/s)."""
    return 0.5 * (damping.mass_rate / frequency + damping.stiffness_time * frequency)


@pytest.mark.parametrize("ratios", [[0.01, 0.01], [0.01, 0.05], [0.02, 0.005], [0.0, 0.0]])
def test_ratios_are_met_at_their_frequencies(ratios):
    damping = parse(damped(ratios)).rail.damping.record()
    for frequency, expected in zip((500.0, 5000.0), ratios):
        assert ratio(damping, 2.0 * math.pi * frequency) == pytest.approx(expected, rel=1e-12)


def test_ratio_between_and_outside():
    """Equal ratios z at f and 10 f: least at their geometric mean, z 2 sqrt(10) / 11, and (a + b) /
    2 outside."""
    damping = parse(damped([0.01, 0.01])).rail.damping.record()
    least = 2.0 * math.pi * math.sqrt(500.0 * 5000.0)
    assert ratio(damping, least) == pytest.approx(0.02 * math.sqrt(10.0) / 11.0, rel=1e-12)
    assert ratio(damping, 10.0 * least) > 0.01 < ratio(damping, 0.1 * least)


@pytest.mark.parametrize("second", [0.1, 0.001])
def test_no_mode_may_gain_energy(second):
    """At z / 10 and 10 z, where K or M alone damp. Beyond, the table is refused (``refusals.rail``)."""
    assert min(parse(damped([0.01, second])).rail.damping.record()) >= 0.0


def test_damping_by_one_of_the_matrices_alone():
    assert parse(damped([0.01, 0.1])).rail.damping.record() == pytest.approx(
        Damping(0.0, 0.01 / (math.pi * 500.0)), rel=1e-12
    )
    assert parse(damped([0.1, 0.01])).rail.damping.record() == pytest.approx(
        Damping(2.0 * math.pi * 100.0, 0.0), rel=1e-12
    )


def test_dotted_keys_set_vary_and_drop_it():
    plain = parse(small())
    scene = plain.replace(
        {"rail.damping.ratios": [0.01, 0.02], "rail.damping.frequencies": [500.0, 5000.0]}
    )
    assert scene.rail.damping.ratios == (0.01, 0.02) and scene.hash != plain.hash
    assert scene.replace({"rail.damping.ratios.1": 0.03}).rail.damping.ratios == (0.01, 0.03)
    assert scene.replace({"rail.damping": None}).hash == plain.hash
    assert parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
    assert "rail.damping" in plain.absent_effects() and "rail.damping" not in scene.absent_effects()


@pytest.mark.parametrize("key", ["mesh", "geometry"])
def test_a_rail_given_by_a_file_takes_it_too(tmp_path, key):
    file = tmp_path / ("rail.msh" if key == "mesh" else "rail.step")
    file.write_bytes(b"")
    box = [{"low": ["0 m"] * 3, "high": ["1 m"] * 3}]
    surfaces = {"surfaces": {"contact_y": box, "mount": box}} if key == "geometry" else {}
    rail = {
        "start": "-0.1 m",
        "end": "0.1 m",
        "material": SMALL["rail"]["material"],
        key: str(file),
    } | surfaces
    raw = small(rail=rail | {"damping": {"ratios": [0.01, 0.01], "frequencies": FREQUENCIES}})
    assert parse(raw).rail.damping.frequencies == (500.0, 5000.0)
    assert load("reference").rail.damping is None
