"""Tables that lack, are empty or have no such name, and the other tables of the small scene."""

from tests.scenes.refusals import case
from tests.scenes.support import FRICTION, SMALL, small
from tipoff.scenes import parse


def made(change):
    return parse(change)


def without(table: str) -> dict:
    return {key: item for key, item in SMALL.items() if key != table}


def scene(keys: str, *words: str, **changed):
    return case(small(**changed), keys, *words)


def pad(keys: str, places: int, *normals: str):
    return scene(keys, pads=[{"position": ["0 m"] * places, "normals": list(normals)}])


EFFECTS = ("initial", "gravity", "thrust_offset", "mass_offset", "output")  # present, without a key
CASES = [
    *(case(without(key), key, "given nothing") for key in ("payload", "rail", "thrust", "pads")),
    *(scene(key, **{key: {}}) for key in EFFECTS),
    case([1, 2], "table", "values by their keys, as a dict or another mapping"),
    scene("payload.mass payload.inertia", payload={}),
    scene("payload.mass", payload__mass="1e201 kg"),
    scene("payload.mass", payload__mass="1e-201 kg"),
    scene(
        "payload.inertia",
        "triangle",  # which the diagonal alone satisfies; the principal moments are 0.1, 1, 1.9
        payload__inertia={"xx": "1 kg*m**2", "yy": "1 kg*m**2", "zz": "1 kg*m**2"}
        | {"xy": "0.9 kg*m**2"},
    ),
    scene("pads", pads=[]),
    pad("pads.0.position", 4, "+y"),
    pad("pads.0.normals", 3, "+y", "+y"),
    pad("pads.0.normals.0", 3, "+x"),
    scene("pads.0.position.0", pads=[{"position": ["1e10 m", "0 m", "0 m"], "normals": ["+y"]}]),
    scene("thrust.kind", thrust={}),
    scene("thrust.kind", thrust__kind="gauss"),
    scene("thrust", thrust__impulse="1 N*s"),
    scene("thrust.rescale", thrust__rescale=True),
    scene("gravity.w", gravity={"w": "1 m/s**2"}),
    scene("frictoin", frictoin=FRICTION),
    scene("provenance.payload.mas", provenance={"payload.mas": "paper"}),
    scene("agreement.fitted", agreement={"fitted": ["a"]}),
    scene(
        "agreement.held_out",
        conditions={"a": {}},
        agreement={"fitted": ["a"], "held_out": ["a"]},
    ),
]
