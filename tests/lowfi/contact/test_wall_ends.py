"""Where a wall ends: stretches shorter than a step, pads that come back behind the surface, walls
that are somewhere else."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.lowfi.compliance import handmade, in_one_cell
from tests.lowfi.contact.compliant.test_runs import EFFECTS, RUB, STIFFNESS, on_springs
from tests.lowfi.support import ONE_PAD, RAIL, numerics, scene, unwatched
from tipoff import lowfi
from tipoff.lowfi.single_run import SingleRun
from tipoff.mechanics import ledger
from validation import oracle

WIDTH, START = 2e-3, 0.1  # m: a wall, and how far ahead of the middle of the pad it begins
K, MASS = 7e7, 20.0
LINEAR = {"law": "linear", "stiffness": K, "damping": 0.0}
SPEEDS = pytest.mark.parametrize("speed", [50.0, 5.0, 0.5])
TOLERANCES = pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
HALF = 0.008  # m, of a pad face along the rail


def short_rail(start: float = START) -> dict:
    return RAIL | {"start": start, "end": start + WIDTH}


@pytest.mark.case("X22")
@SPEEDS
@TOLERANCES
def test_a_wall_shorter_than_a_step(speed, tolerance):
    """A pad meets the wall's surface 0.3 of the way over it, at a hundredth of its axial speed. It
    moves as v cos(w t) until the wall ends or until pi / w. Each of the few steps has an error of
    ``tolerance`` times the speed."""
    across, over = 0.01 * speed, WIDTH / speed
    contact_time = START / speed + 0.3 * over
    asked = scene(
        2.0 * contact_time,
        0.1 * contact_time,
        rail=short_rail(),
        contact=LINEAR | {"clearance": across * contact_time},
        initial={"velocity": {"x": speed, "z": -across}},
    )
    run = lowfi.run(asked, "springs", numerics=numerics(tolerance))
    turn = math.sqrt(K / MASS) * 0.7 * over
    expected = -across * math.cos(min(turn, math.pi))
    error = 3.0 * tolerance * across
    assert run.status != "diverged" and run.velocity[-1, 2] == pytest.approx(expected, abs=error)
    assert run.checks["energy_error"] <= 1e-6
    # Control: a method that checks only the ends of its steps misses the wall.
    blind = oracle.solve(asked, 1, samples=8).velocity[-1, 2]
    assert blind == pytest.approx(-across, rel=1e-12) and abs(expected + across) > 3.0 * error


@TOLERANCES
def test_a_touch_between_two_ends(tolerance):
    """Pulled off the wall by 1 g, the pad touches only while it is over it: the gap is open at both
    ends of the wall. It bounces, and comes off earlier than in free flight through the surface, by
    an amount that the spring determines."""
    speed, depth, g, stiffness = 5.0, 5e-8, 9.80665, 7e9
    top = (START + 0.5 * WIDTH) / speed  # when it would be deepest
    late = math.sqrt(2.0 * depth / g)
    assert late < 0.5 * WIDTH / speed
    w, fast = math.sqrt(stiffness / MASS), g * late
    # p'' = -w^2 p - g from p = 0, p' = fast, until p = 0
    pressed = 2.0 / w * math.atan(fast * w / g)
    spring = LINEAR | {"stiffness": stiffness, "clearance": 0.5 * g * top**2 - depth}
    asked = scene(
        2.0 * top,
        0.1 * top,
        rail=short_rail(),
        contact=spring,
        gravity={"z": g},
        initial={"velocity": {"x": speed, "z": -g * top}},
    )
    run = lowfi.run(asked, "springs", numerics=numerics(tolerance))
    saved = g * (2.0 * late - pressed)
    assert run.velocity[-1, 2] == pytest.approx(g * (run.time[-1] - top) + saved, abs=0.02 * saved)
    assert abs(saved) > 1e-4  # control: without the contact it is off by this


def test_a_wall_reached_and_left_over_the_same_end():
    """Thrown at the rail's mouth from outside against a pull of 1 g, the pad turns 1 mm inside it
    and bounces there; free flight takes one step for all of that."""
    inside, g, across = 1e-3, 9.80665, 0.05
    begin = 5e-3
    back = math.sqrt(2.0 * g * (begin + inside))
    turns = back / g
    asked = scene(
        2.0 * turns,
        2.0 * turns,
        rail=RAIL | {"end": 0.0},
        contact=LINEAR | {"clearance": across * turns},
        gravity={"x": g},
        initial={"position": {"x": begin}, "velocity": {"x": -back, "z": -across}},
    )
    run = unwatched(asked, numerics(1e-6)).trajectory()
    assert run.velocity[-1, 2] == pytest.approx(across, rel=1e-5)
    assert run.position[-1, 0] == pytest.approx(begin, abs=1e-9)


def one_pad(**changes):
    """A payload that does not turn, with a pad in one corner of endless rails; contact springs or
    compliant contact."""
    stout = {"mass": 9.9, "inertia": {"xx": 1e6, "yy": 1e6, "zz": 1e6}}
    still = {"mass": 1e9, "inertia": {"xx": 1e9, "yy": 1e9, "zz": 1e9}, "mass_centre": {"x": 0.0}}
    pads = [
        {
            "position": (0.0, 0.1, 0.1),
            "normals": ["+y", "+z"],
            "length": 2 * HALF,
            "width": 2 * HALF,
            "inset": 0.009,
            "relief": 0.0,
        }
    ]
    return on_springs(
        RUB | {"static": 0.0, "dynamic": 0.0},
        **{
            "payload": stout,
            "platform": still,
            "pads": pads,
            "thrust": EFFECTS["thrust"] | {"peak": 0.0},
        }
        | changes,
    )


@pytest.mark.case("X22")
@SPEEDS
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_short_compliant_wall(monkeypatch, speed, tolerance):
    """A pad of one cell presses with the share of it that is over the wall: m y'' = -k share(t) y,
    against another solver."""
    in_one_cell(monkeypatch)
    across, over = 0.01 * speed, (WIDTH + 2.0 * HALF) / speed
    contact_time = (START - HALF) / speed + 0.3 * over
    asked = one_pad(
        rail=short_rail(),
        duration=2.0 * contact_time,
        output={"interval": 0.1 * contact_time},
        # which lets steps be as long as they want
        thrust=EFFECTS["thrust"] | {"peak": 0.0, "width": 1.0},
        initial={"velocity": {"x": speed, "y": across}},
    ).replace({"contact.clearance": across * contact_time})
    run = lowfi.run(asked, numerics=numerics(tolerance), compliance=handmade(asked, {}))
    expected = pressed_by_a_share(speed, across, contact_time, over)
    error = run.cost["steps"] * tolerance * across
    assert run.status != "diverged" and run.velocity[-1, 1] == pytest.approx(expected, abs=error)
    assert abs(expected - across) > 5.0 * error  # control: the speed without contact


def pressed_by_a_share(speed: float, across: float, contact_time: float, over: float) -> float:
    """Velocity across (m/s) once the pad has left the wall, its last hundredth at once."""

    def share(time):
        front, rear = speed * time + HALF, speed * time - HALF
        return (min(START + WIDTH, front) - max(START, rear)) / (2.0 * HALF)

    def slope(time, state):
        return [state[1], -STIFFNESS / 9.9 * share(time) * max(state[0], 0.0)]

    end = (START + WIDTH + 0.99 * HALF) / speed
    return solve_ivp(
        slope, (contact_time, end), [0.0, across], rtol=1e-10, atol=1e-14, max_step=1e-3 * over
    ).y[1, -1]


MOUTH = 0.05  # m, the end of a rail
CLEARANCE = 1e-4  # m, of ``on_springs``


def thrown_back(depth: float, away: float = 0.0):
    """Wholly past the mouth by 3 mm, shifted aside until the pad is ``depth`` (m) behind its wall's
    surface, and back at 6 m/s, moving ``away`` (m/s) from the other wall of its corner."""
    return one_pad(
        rail=RAIL | {"end": MOUTH},
        output={"interval": 2e-5},
        initial={
            "position": {"x": MOUTH + HALF + 3e-3, "y": CLEARANCE + depth},
            "velocity": {"x": -6.0, "z": -away},
        },
    )


@pytest.mark.case("X21")
@pytest.mark.parametrize("given", [False, True], ids=["springs", "compliant"])
def test_back_into_the_mouth(given):
    """A pad behind the surface strikes the rail's end; over the surface, or behind the whole wall,
    it flies in. It never gains energy."""
    for depth in (1e-5, 1e-3, 3.9e-3):
        asked = thrown_back(depth)
        run = lowfi.run(
            asked,
            "compliant" if given else "springs",
            compliance=handmade(asked, {}) if given else None,
        )
        # compliant contact takes the whole pad, springs its middle
        way = 3e-3 + (0.01 * HALF if given else HALF)
        assert run.status == "diverged" and run.outcome.exit_time is None
        assert (
            "pad 0 strikes the open end of its rail with its face +y" in run.message
            and f"{depth * 1e3:.4g} mm" in run.message
        )
        assert run.time[-1] == pytest.approx(way / 6.0, abs=2.1e-5)
        assert not run.pad_force.any() and run.velocity[-1] == pytest.approx(
            [-6.0, 0.0, 0.0], abs=1e-12
        )
    for depth in (-1e-5, 5e-7, 4.5e-3, 0.05):
        asked = thrown_back(depth, away=0.1)
        run = unwatched_on(asked, handmade(asked, {}) if given else None)
        assert run.status != "diverged" and run.message == ""
        # Rounded edges may ride up by a micrometre: k p^2 / 2 of half that.
        gained = run.energy[:, ledger.ENTRIES.index("kinetic")].max() - 0.5 * 9.9 * (36.0 + 0.01)
        assert gained <= 0.5 * STIFFNESS * 5e-7**2 * 1.01
        assert depth == 5e-7 or not run.pad_force.any()
    # Control: where nothing else moves across the rail, that energy is the whole transverse energy.
    # Springs create it, compliant walls take it from the motion along the rail.
    asked = thrown_back(5e-7)
    run = unwatched_on(asked, handmade(asked, {}) if given else None)
    created = run.status == "diverged" and "came from nothing" in run.message
    assert created != given
    assert given or run.outcome.rate is None


def unwatched_on(asked, compliance):
    """A run over the scene's whole duration, also after an exit or a jam."""
    run = SingleRun(asked, lowfi.Numerics(), compliance)
    run.whole = True
    run.begin()
    run.integrate(None)
    return run.trajectory()


@pytest.mark.case("X21")
@pytest.mark.parametrize("given", [False, True], ids=["springs", "compliant"])
def test_two_kilometres_away(given):
    """A payload far beside its rails has no contact: neither with the wall it is behind, nor with
    the one whose plane it has crossed by a hundredth of a millimetre."""
    asked = one_pad(
        initial={"position": {"y": 2000.0, "z": CLEARANCE + 1e-5}, "velocity": {"x": 1.0}}
    )
    run = lowfi.run(
        asked,
        "compliant" if given else "springs",
        compliance=handmade(asked, {}) if given else None,
    )
    assert run.status == "time_limit" and run.message == "" and not run.pad_force.any()
    assert run.velocity[-1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    # control: the same crossing where the wall is
    near = asked.replace({"initial.position.y": 0.0})
    assert lowfi.run(
        near, "compliant" if given else "springs", compliance=handmade(near, {}) if given else None
    ).pad_force.any()


@pytest.mark.parametrize(
    "start, speed, stiffness, words",
    [(-0.0045, 1.0, 7e7, "strikes the back"), (0.0, -1.0, 1e3, "is pressed through a wall")],
)
def test_the_back_of_a_wall(start, speed, stiffness, words):
    """A wall is 4 mm thick: a pad behind it that comes back strikes its back, and one that is
    pressed in as deep has passed through."""
    asked = scene(
        0.02,
        1e-4,
        contact=LINEAR | {"clearance": 1e-4, "stiffness": stiffness},
        initial={"position": {"z": start}, "velocity": {"x": 1.0, "z": speed}},
    )
    run = lowfi.run(asked, "springs", numerics=numerics(1e-7))
    assert run.status == "diverged" and f"pad 0 {words} of its rail with its face -z" in run.message
    if start < 0.0:
        assert run.time[-1] == pytest.approx(4e-4, abs=1.1e-4) and not run.pad_force.any()
    assert run.checks["energy_error"] <= 1e-6 and run.velocity[-1, 2] == pytest.approx(
        speed, rel=1e-2
    )


def test_a_pad_half_over_the_end_moves_in_and_out():
    """The middle of a pressed pad is 2 um past the end for a tenth of a millisecond and then comes
    back; its rear half stays on the rail. It takes its stored energy out and may bring it back, but
    not the energy of what it sank in between."""
    weight = MASS * 9.80665
    pull, deep = 1000.0, weight / K
    back = math.sqrt(2.0 * pull * 3e-6)
    asked = scene(
        2.5 * back / pull,
        1e-5,
        rail=RAIL | {"end": 0.0},
        contact=LINEAR | {"clearance": 0.0},
        pads=ONE_PAD,
        gravity={"x": -pull, "z": -9.80665},
        initial={"position": {"x": -1e-6, "z": -deep}, "velocity": {"x": back}},
    )
    run = unwatched(asked, numerics(1e-7)).trajectory()
    pressed = run.pad_force[:, 0, 2] > 0.0
    assert "strikes" not in run.message and pressed[0] and pressed[-1] and not pressed.all()
    gained = -run.energy[-1, ledger.ENTRIES.index("released")]
    sunk = 0.5 * 9.80665 * (run.time[-1] - np.count_nonzero(pressed) * 1e-5) ** 2
    # the time off the rail has an error of one sample
    assert gained == pytest.approx(weight * sunk, rel=0.3)
    scale = run.energy[:, ledger.ENTRIES.index("kinetic")].max()
    assert run.status == "diverged" and run.checks["energy_error"] == pytest.approx(
        gained / scale, rel=0.1
    )


@pytest.mark.slow
def test_ensembles_end_as_single_runs_do():
    """Status, message and outcome of each row, bit for bit."""
    depths = (-1e-5, 1e-3, 3.9e-3, 0.02)
    asked = thrown_back(0.0)
    rows = [{"initial.position.y": CLEARANCE + depth} for depth in depths]
    found, single = (
        lowfi.run_many(asked, rows, "springs"),
        [lowfi.run(asked.replace(row), "springs") for row in rows],
    )
    assert (
        found.status.values.tolist()
        == [run.status for run in single]
        == ["exited", "diverged", "diverged", "exited"]
    )
    assert found.message.values.tolist() == [run.message for run in single]
