"""``[hold_down]``, and ``[initial] settled``, some of them when the run begins."""

from tests.lowfi.support import PAPER_PAD, G, corners, scene
from tests.scenes.refusals import case
from tipoff import lowfi

PULSE = {"kind": "gaussian", "peak": 4000.0, "width": 2e-3, "centre": 6e-3}
LATE = {"kind": "constant", "force": 500.0, "start": 5e-3, "duration": 0.1}
WEIGHT = {"gravity": {"x": 0.0, "y": 0.0, "z": -G}, "initial": {"settled": True}}
PLATFORM = {"mass": 50.0, "inertia": {"xx": 1.0, "yy": 1.0, "zz": 1.0}}
HELD = {"hold_down": {"release": 1000.0}}


RESTING, LATCHED = WEIGHT | {"thrust": LATE}, HELD | {"thrust": PULSE}


def made(change: dict):
    tables = RESTING if change["settled"] else LATCHED
    asked = scene(0.014, 1e-4, mass=20.0, contact=PAPER_PAD, pads=corners(), **tables)
    asked = asked.replace({key: item for key, item in change.items() if key != "settled"})
    lowfi.run(asked, "springs")


def held(keys: str, *words: str, settled: bool = False, **changed):
    keyed = {key.replace("__", "."): item for key, item in changed.items()}
    return case(keyed | {"settled": settled}, keys, *words)


def settled(keys: str, *words: str, **changed):
    return held(keys, *words, settled=True, **changed)


SPRING = {"kind": "spring", "preload": 100.0, "rate": 1000.0, "stroke": 0.01}
MOST = "given 5000 N, expected at most the largest thrust, 4000 N"
NONE = "hold_down: given a table, expected none: springs push"
CASES = [
    held("hold_down.release", MOST, hold_down__release=5000.0),
    held("initial", "given a velocity along the rail", initial__velocity__x=1.0),
    held("hold_down.release", hold_down__release=-1.0),
    held("hold_down", "exactly one of release and release_time", hold_down__release_time=1e-3),
    held(
        "hold_down.release_time",
        "given 1 s, expected less than the duration, 0.014 s",
        hold_down={"release_time": 1.0},
    ),
    held("hold_down", NONE, thrust=SPRING),
    settled("gravity", "gravity: given nothing, expected a weight", gravity=None),
    settled("contact", "contact: given nothing", contact=None, friction=None),
    settled("platform", "free platform", platform=PLATFORM),
    settled("initial", "given a velocity", initial__velocity__z=1e-3),
    # no wall holds it
    settled("initial.settled", "expected walls and a weight", pads=corners(normals="y")),
]
