"""The same scene in other units is accepted or refused alike: values on a limit, and parts that abut."""

import itertools
import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.scenes.support import CONTACT, FRICTION, small
from tipoff import highfi
from tipoff.comparison.curves import Curves
from tipoff.scenes import SceneError, load, parse, rounding
from tipoff.scenes.distributions import Uniform
from tipoff.units import duration

LENGTHS = {"m": 1e6, "cm": 1e4, "mm": 1e3, "um": 1.0, "inch": 25400.0, "ft": 304800.0}
REAR = -8000  # um, X of the rear edge of the pads of a small scene: a rail ends beyond it
TIMES = {"s": 1e6, "ms": 1e3, "us": 1.0, "min": 60e6}
SPEEDS = {"m/s": 1e6, "mm/s": 1e3, "um/s": 1.0, "inch/s": 25400.0, "cm/min": 1e4 / 60.0}
units_of_length, units_of_time = st.sampled_from(sorted(LENGTHS)), st.sampled_from(sorted(TIMES))


def length(micrometres: float, unit: str) -> str:
    return f"{micrometres / LENGTHS[unit]!r} {unit}"


def accepted(raw: dict) -> bool:
    try:
        parse(raw)
    except SceneError:
        return False
    return True


def rail(start, borders, leg, thickness, mount_width, units) -> dict:
    """Mounts that abut from the rear end of a rail to its open end; lengths in um, a unit for each."""
    draw = itertools.cycle(units).__next__
    spans = list(itertools.pairwise([0, *itertools.accumulate(borders)]))
    return {
        "start": length(start, draw()),
        "end": length(start + sum(borders), draw()),
        "leg": length(leg, draw()),
        "thickness": length(thickness, draw()),
        "mount_width": length(mount_width, draw()),
        "mounts": [{"start": length(a, draw()), "end": length(b, draw())} for a, b in spans],
        "material": small()["rail"]["material"],
    }


@settings(deadline=None, max_examples=150)
@given(
    st.integers(-300_000, 300_000),
    st.lists(st.integers(1, 200_000), min_size=1, max_size=4),
    st.integers(1000, 60_000),
    st.lists(units_of_length, min_size=5, max_size=13),
)
def test_a_rail_is_accepted_in_any_units(start, borders, leg, units):
    """Mounts abut and end with the rail, a wall is 1 um thinner than its leg, and mounts are as wide as
    the leg. Control: each limit passed by 1 um is refused in the same units."""
    assume(start + sum(borders) > REAR)
    table = rail(start, borders, leg, leg - 1, leg, units)
    scene = parse(small(rail=table, contact=CONTACT))
    assert len(scene.rail.mounts) == len(borders)
    beyond = dict(table, end=length(start + sum(borders) - 1, units[0]))
    assert not accepted(small(rail=beyond))
    if len(borders) > 1:
        overlap = [dict(span) for span in table["mounts"]]
        overlap[1]["start"] = length(borders[0] - 1, units[0])
        assert not accepted(small(rail=dict(table, mounts=overlap)))
    assert not accepted(small(rail=dict(table, thickness=length(leg, units[0]))))
    assert not accepted(small(rail=dict(table, mount_width=length(leg + 1, units[-1]))))


@pytest.mark.parametrize("backwards", [False, True])
def test_abutting_mounts_in_different_units_are_meshed(backwards):
    """1 to 3 mm, and 3 to 24 mm, where the last bits of both 3 mm differ, in either order: the mesh is that
    of equal bits. Control: the second mount alone holds fewer facets."""
    spans = [
        {"start": "1 mm", "end": f"{0.1 + 0.2!r} cm"},
        {"start": "3 mm", "end": "24 mm"},
    ]
    assert 0.1 + 0.2 > 0.3

    def held(mounts):
        scene = load("tiny").replace({"rail.mounts": mounts})
        mesh = highfi.prepare(scene, highfi.Numerics(element_size=8e-3))
        return len(mesh.cells), len(mesh.surfaces["mount"])

    one = held([{"start": "1 mm", "end": "3 mm"}, {"start": "3 mm", "end": "24 mm"}])
    assert held(spans[::-1] if backwards else spans) == one
    assert held([{"start": "3 mm", "end": "24 mm"}])[1] < one[1]


@settings(deadline=None, max_examples=100)
@given(st.integers(1, 10**6), st.integers(1, 10**6), units_of_time, units_of_time)
def test_samples_and_durations_in_any_units(interval, count, one, other):
    """A duration of one sample, and of as many as there may be. Control: a little less, or more."""
    interval = min(interval, int(3.6e9))

    def scene(duration):
        return small(
            duration=f"{duration / TIMES[one]!r} {one}",
            output={"interval": f"{interval / TIMES[other]!r} {other}"},
            thrust={"kind": "constant", "force": "1 kN", "duration": "1 us"},
        )

    assert accepted(scene(interval))
    assert not accepted(scene(interval * (1.0 - 1e-9)))
    if interval * 1_000_000 <= 3.6e9:
        assert accepted(scene(interval * 1_000_000))
        assert not accepted(scene(interval * 1_000_001))


@settings(deadline=None, max_examples=100)
@given(
    st.integers(1, 10**7),
    st.sampled_from(sorted(SPEEDS)),
    st.sampled_from(sorted(SPEEDS)),
)
def test_two_equal_speeds_are_refused_in_any_units(speed, one, other):
    """A transition needs a width. Control: a millionth more."""

    def friction(factor):
        return FRICTION | {
            "static_speed": f"{speed / SPEEDS[one]!r} {one}",
            "dynamic_speed": f"{factor * speed / SPEEDS[other]!r} {other}",
        }

    assert not accepted(small(contact=CONTACT, friction=friction(1.0)))
    assert accepted(small(contact=CONTACT, friction=friction(1.0 + 1e-6)))


@pytest.mark.parametrize("unit", sorted(LENGTHS))
def test_dimensions_on_their_bound(unit):
    """The least dimension of a rail is 1 um, the finest elements 0.05 mm, the coarsest 100 mm."""
    raw = small(rail__leg=length(2, unit), rail__thickness=length(1, unit))
    raw["rail"]["mount_width"] = length(1, unit)
    assert parse(raw).rail.thickness == pytest.approx(1e-6, rel=1e-11)
    raw["rail"]["thickness"] = length(0.999, unit)
    assert not accepted(raw)
    for size, sound in ((50, True), (100_000, True), (49.99, False), (100_001, False)):
        raw = small(studies={"element_size": length(size, unit)})
        assert accepted(raw) == sound
        if sound:
            found = parse(raw).studies
            assert found.element_size == pytest.approx(1e-6 * size)


@pytest.mark.parametrize("hour", ["3600 s", "60 min", "1 hour", "3.6e6 ms", "3.6e9 us", "1/24 day"])
def test_the_longest_run_in_any_unit(hour):
    if hour.startswith("1/24"):
        hour = f"{1.0 / 24.0!r} day"
    raw = small(duration=hour, output={"interval": "1 s"})
    assert parse(raw).duration == 3600.0
    raw["duration"] = "3600.001 s"
    assert not accepted(raw)


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 200), st.sampled_from(["ms", "us", "s", "min"]), st.integers(0, 3))
def test_windows_and_steps_of_curves_in_any_unit(tmp_path_factory, count, unit, first):
    """Samples 1 ms apart, the longest step, from 0 or 1 ms on; the window begins with the record or
    ends with it. Control: 1 % more."""
    folder, size = tmp_path_factory.mktemp("curves"), TIMES[unit] * 1e-6

    def written(step):
        times = [(0.001 * (first > 1) + step * row) / size for row in range(count + 3)]
        rows = "".join(f"{time!r},1,0,0,0\n" for time in times)
        head = f"time [{unit}],velocity_x [m/s],rate_x [rad/s],rate_y [rad/s],rate_z [rad/s]\n"
        (folder / "curve.csv").write_text(head + rows)
        return folder / "curve.csv"

    begin = 0.001 * (first > 1)
    for start in (None, begin, begin + 0.001 * (count + 2) - 0.002):
        assert Curves.read(written(0.001), start).time.size > 1
    with pytest.raises(SceneError, match="a gap"):
        Curves.read(written(0.00101))


def test_limits_that_are_computed():
    """0.1 + 0.2 is more than 0.3 by a last bit. Control: plain comparison."""
    assert 0.1 + 0.2 > 0.3
    assert rounding.at_most(0.1 + 0.2, 0.3) and not rounding.below(0.3, 0.1 + 0.2)
    assert rounding.below(0.3, 0.3000001) and not rounding.at_most(0.3000001, 0.3)
    assert rounding.at_most(1.0, math.inf) and rounding.below(-math.inf, 0.0)
    assert rounding.below(1.0, math.inf) and not rounding.at_most(math.inf, 1.0)
    assert rounding.on(0.1 + 0.2, (0.3, 1.0)) == 0.3 and rounding.on(0.31, (0.3, 1.0)) == 0.31
    # a difference of large numbers
    assert rounding.at_most((1.0 + 0.1) - 1.0, 0.1, scale=1.0)
    with pytest.raises(ValueError, match="more than low"):
        Uniform.model_validate(
            {"distribution": "uniform", "low": 0.3, "high": 0.1 + 0.2},
            context={"units": {}, "bare_numbers_are_si": True, "unit": None},
        )


@pytest.mark.parametrize("limit", [-0.088, 1e-9, 0.25, 44.4, 6.5e10])
@pytest.mark.parametrize("off", [1e-1, 1e-5, 1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("shown", [rounding.plain, duration], ids=["number", "time"])
def test_a_refused_value_and_its_limit_have_two_texts(limit, off, shown):
    """Control: a fixed number of digits gives one text for both."""
    given, most = rounding.apart(limit * (1.0 + off), limit, 4, shown)
    assert given != most and len(most) <= len(f"{limit:.14g}") + 4
    assert (shown(limit * (1.0 + off), 4) == shown(limit, 4)) == (off < 1e-4)


def test_equal_values_have_one_short_text():
    assert rounding.apart(0.1 + 0.2, 0.3) == ("0.3", "0.3")


def test_a_rail_that_ends_just_behind_the_pads_is_told_apart_from_its_limit():
    end = min(pad.position[0] - 0.5 * pad.length for pad in load("tiny").pads)
    with pytest.raises(SceneError) as error:
        load("tiny").replace({"rail.end": end - 1e-8, "rail.start": -0.4, "rail.mounts": []})
    (fault,) = error.value.faults
    assert fault.given == "-0.08800001 m" and fault.expected.startswith("more than -0.088 m")
