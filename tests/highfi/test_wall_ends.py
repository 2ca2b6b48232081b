"""Pads that come back to their rail where no contact is modelled: behind the surface of a wall,
from its mouth or from its back."""

import re

import numpy as np
import pytest

from tests.highfi.support import COARSE, tiny
from tipoff import highfi
from tipoff.mechanics import ledger

SPEED = 3.0  # m/s
CLEARANCE, HALF, END = 0.25e-3, 0.008, 0.136  # m, of the tiny scene
REAR = -0.080  # m, the rear pads
SHORT = {"thrust__peak": "0 N", "duration": "2.5 ms"}


def thrown_back(depth: float):
    """Rear pads wholly past the mouth by 3 mm, shifted aside until two of their faces are ``depth``
    (m) behind the surface."""
    return tiny(
        **SHORT,
        initial__position__x=END + HALF + 3e-3 - REAR,
        initial__position__y=CLEARANCE + depth,
        initial__velocity__x=-SPEED,
    )


def energy(run, entry: str) -> np.ndarray:
    return run.energy[:, ledger.ENTRIES.index(entry)]


@pytest.mark.case("X21")
@pytest.mark.parametrize("depth", [1e-3, 3.5e-3])
def test_back_into_the_mouth_behind_the_surface(depth):
    """The run ends where the pad meets the end of the rail, at its initial speed."""
    asked = thrown_back(depth)
    assert (asked.contact.clearance, asked.pads[0].length, asked.rail.end) == pytest.approx(
        (CLEARANCE, 2.0 * HALF, END)
    )
    run = highfi.run(asked, COARSE)
    assert run.status == "diverged" and run.outcome.exit_time is None
    assert "strikes an edge" in run.message and "face +y" in run.message and not run.pad_force.any()
    # To a step of less than a microsecond.
    struck = float(re.search(r"at ([0-9.e-]+) s:", run.message)[1])
    assert struck == pytest.approx(3e-3 / SPEED, abs=1e-6)
    assert 0.0 <= run.time[-1] - struck <= 1.1e-4
    assert run.velocity[-1] == pytest.approx([-SPEED, 0.0, 0.0], abs=1e-9)
    assert (
        energy(run, "kinetic") == pytest.approx(energy(run, "kinetic")[0], rel=1e-12)
        and not energy(run, "contact_stored").any()
    )


@pytest.mark.case("X21")
@pytest.mark.parametrize("depth", [-1e-4, 0.02])
def test_back_into_the_mouth_elsewhere(depth):
    """Over the surface, or behind the whole wall, the pad meets nothing."""
    run = highfi.run(thrown_back(depth), COARSE)
    assert run.status != "diverged" and run.message == "" and not run.pad_force.any()
    assert energy(run, "kinetic").max() <= energy(run, "kinetic")[0] * (1.0 + 1e-12)


@pytest.mark.case("X21")
def test_two_kilometres_away():
    """No contact there. Control: the same crossing at the wall has contact."""
    crossing = {
        "initial__position__z": CLEARANCE + 5e-5,
        "initial__velocity__x": 1.0,
        "thrust__peak": "0 N",
        "duration": "0.2 ms",
    }
    far, near = (
        highfi.run(tiny(**crossing, initial__position__y=y), COARSE) for y in (2000.0, 0.0)
    )
    assert far.status == "time_limit" and far.message == "" and not far.pad_force.any()
    assert (
        far.velocity[-1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
        and np.abs(near.pad_force).max() > 1.0
    )


def test_back_through_the_wall():
    """A pad behind a wall of 4 mm that comes back strikes its back, and had no contact before."""
    run = highfi.run(
        tiny(**SHORT, initial__position__y=CLEARANCE + 4.5e-3, initial__velocity__y=-1.0), COARSE
    )
    assert run.status == "diverged" and "back" in run.message and "4 mm behind" in run.message
    assert run.time[-1] == pytest.approx(5e-4, abs=1.1e-4) and not run.pad_force.any()
