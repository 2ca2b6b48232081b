"""``[thrust]`` of springs, in numbers and in a table of travel and force."""

from tests.scenes.refusals import Written, case
from tests.scenes.support import small
from tipoff.scenes import parse

SPRING = {"kind": "spring", "preload": "100 N", "rate": "2 N/mm", "stroke": "40 mm"}
WITHOUT = {"preload": None, "rate": None, "stroke": None}
TABLE = "travel [mm],force [N]\n0,100\n10,90\n40,20\n"


def made(change: dict):
    return parse(small(thrust={key: item for key, item in change.items() if item is not None}))


def spring(keys: str, *words: str, **changed):
    return case(SPRING | changed, keys, *words)


def table(text: str, *words: str, **changed):
    return case(SPRING | WITHOUT | {"file": Written(text)} | changed, "thrust.file", *words)


CASES = [
    spring("thrust.stroke", "preload, rate and stroke, or a file", stroke=None),
    # pulls at its end, is held by friction, stops on its way
    spring("thrust.stroke", "at most 0.05 m", stroke="60 mm"),
    spring("thrust.friction", "nothing starts", friction="100 N"),
    spring("thrust.friction", "at most 20 N", friction="30 N"),
    spring("thrust.stroke", "the way to the exit", rate="0 N/m", stroke="400 mm"),
    spring("thrust.preload", "greater than 0", preload="0 N"),
    spring("thrust.rate", "N/m", rate="2 N"),
    spring("thrust.reaction", "platform", reaction="exhaust"),
    spring("thrust.stroke thrust.friction", stroke="60 mm", friction="100 N"),
    spring("thrust.file", "one or the other", file=Written(TABLE)),
    case(
        {
            "kind": "springs",
            "springs": [
                {"preload": "0 N", "rate": "2 N/mm", "stroke": "40 mm"},
                {"preload": "9 N", "rate": "2 N/mm"},
            ],
        },
        "thrust.springs.0.preload thrust.springs.1.stroke",
    ),
    table("travel [mm],force [N]\n0,9\n2,8\n1,7\n", "rises from point to point (point 3"),
    table("travel [mm],force [N]\n0,9\n2,8\n2,7\n", "rises"),
    table("travel [mm],force [N]\n1,9\n2,8\n", "begins at 0"),
    table("travel [mm],force [N]\n0,9\n", "at least two points"),
    table("travel [mm],force [N]\n0,9\n2,-8\n", "not negative"),
    table("travel [mm],force [N]\n0,0\n2,8\n", "nothing starts"),
    table("travel [mm],force [N]\n1,-9\n0,8\n", "begins at 0", "rises", "not negative"),
    table("travel,force\n0,9\n2,8\n", "the unit of the column"),
    table("time [s],force [N]\n0,9\n2,8\n", "once in the header"),
    table("travel [mm],force [N]\n0,a\n2,8\n", "finite number"),
    table("travel [mm],force [N]\n0,34,5\n2,8\n", "more in line 2"),
    table("\n", "no line"),
    table("", "once in the header"),
]
