"""``[thrust]`` that was measured: the curve of a file, or points in the scene."""

from tests.scenes.refusals import Written, case
from tests.scenes.support import small
from tipoff.scenes import parse

POINTS = {"kind": "measured", "points": [[0, 0], [8, 1.2], [12, 5.9], [12, 3.1], [24, 0]]}
POINTS |= {"time_unit": "ms", "thrust_unit": "kN"}
HEAD = "time_s,force_N\n"


def made(change: dict):
    return parse(small(thrust={key: item for key, item in change.items() if item is not None}))


def curve(content, *words: str, key: str = "thrust.file", **changed):
    return case({"kind": "measured", "file": Written(content)} | changed, key, *words)


def points(keys: str, *words: str, **changed):
    return case(POINTS | changed, keys, *words)


CASES = [
    curve(HEAD + "0,0\n2,5\n1,0\n", "increasing order (line 4)"),
    curve(HEAD + "0,0\n0,5\n", "at least two different times"),
    curve(HEAD + "0,0\n1,5\n1,6\n1,7\n2,0\n", "at most two rows"),
    curve(HEAD + "0,0\n", "at least two different times"),
    curve(HEAD, "at least two different times"),
    curve(HEAD + "-1,0\n1,5\n", "not negative"),
    curve(HEAD + "0,nan\n1,5\n", "finite"),
    curve(HEAD + "0,1\nnan,5\n2,1\n", "finite"),
    curve(HEAD + "0,a\n1,5\n", "finite number"),
    curve(HEAD + "1,inf\n-1,5\n", "finite", "not negative", "increasing"),
    curve("time_s,force_N\n0\n1\n", "two numbers"),
    curve("time_s,force_N\n0,1,2\n1,5,2\n", "two numbers"),
    curve("0,1\n1,5\n", "header"),
    curve("", "header"),
    curve("time_kg,force_N\n0,1\n1,5\n", "header"),
    curve(b"\xff\xfe\x00", "CSV file"),
    case({"kind": "measured", "file": "/none.csv"}, "thrust.file", "CSV file"),
    case({"kind": "measured", "file": "/"}, "thrust.file", "CSV file"),
    # without readings before the ignition there is no offset to take out
    curve(
        HEAD + "0,50\n1,60\n2,0\n",
        "at least 5 points before ignition",
        key="thrust.remove_offset",
        remove_offset=True,
    ),
    points("thrust.points", "thrust.time_unit", time_unit=None),
    points("thrust.points", "quantity in s", time_unit="kN", thrust_unit="ms"),
    points("thrust.points", "increasing order (point 3)", points=[[0, 0], [2, 1], [1, 1]]),
    points("thrust.points", "two different times", points=[[0, 0]]),
    points("thrust.points", "finite", points=[[0, float("nan")], [1, 1]]),
    points("thrust.file", "a file, or points", points=None),
    points("thrust.points", "without thrust.motor", motor="M1670"),
    points("thrust.points", "around thrust.ignition", ignition="1 s"),
    points("thrust.points", "one or the other", file=Written("0,0\n1,1\n")),
]
