"""Parts of a rocket and of a deployer: ``[[buttons]]``, ``[deployer]``, ``origin`` and what goes with
them; and ``[pads]`` by a pattern."""

from tests.scenes.refusals import case
from tests.scenes.support import small
from tests.scenes.test_deployer import DEPLOYER
from tests.scenes.test_pads import PATTERN
from tests.scenes.test_parts import ROCKET
from tipoff.scenes import parse

WHOLE = {"rocket": ROCKET, "deployer": DEPLOYER, "pads": small(pads=PATTERN)}


def made(change: tuple):
    base, tables = change
    raw = WHOLE[base] | tables
    return parse({key: item for key, item in raw.items() if item is not None})


def rocket(keys: str, *words: str, **tables):
    return case(("rocket", tables), keys, *words)


def deployer(keys: str, *words: str, **tables):
    return case(("deployer", tables), keys, *words)


def pattern(keys: str, **changed):
    return case(("pads", {"pads": PATTERN | changed}), keys)


OWN = {"place": "1 m", "profile": "1515", "neck": "7 mm", "neck_to_slot": "1 mm"}
PAIR = [
    {"place": "0.3 m", "profile": "1515", "neck": "9 mm", "head": "30 mm"},
    {"place": "1 m", "neck_height": "1 mm"},
]
CASES = [
    rocket("pads", pads=[{"position": ["0 m"] * 3, "normals": ["+y"]}]),
    rocket("buttons", buttons=[]),
    rocket("buttons.0.place buttons.0.profile", buttons=[{"place": "1 kg", "profile": "2020"}]),
    rocket("rail.section", buttons=[{"place": "1 m"}]),
    rocket(
        "buttons.0.neck buttons.0.head"
        " buttons.1.neck buttons.1.head buttons.1.neck_height buttons.1.head_to_lip",
        buttons=PAIR,
    ),
    rocket("buttons.0.neck_to_slot", buttons=[OWN]),
    rocket("payload.mass_centre payload.diameter", payload={"mass": "1 kg", "length": "1 m"}),
    rocket("payload.mass", payload=ROCKET["payload"] | {"mass": "4 m"}),
    rocket("gravity.x", gravity={"inclination": "84 deg", "x": "1 m/s**2"}),
    rocket("origin", origin="middle"),
    rocket("payload.mass_centre", "origin", origin=None),
    deployer("deployer.cubesat", deployer={"cubesat": "4u"}),
    deployer("deployer.cubesat", deployer={}),
    deployer("deployer", deployer="3u"),
    deployer("deployer.cubesat deployer.door", deployer={"cubesat": ["3u"], "door": 1}),
    deployer("payload.mass", payload={"mass": "4 m"}),
    deployer("deployer payload.diameter", buttons=[{"place": "0 m", "profile": "1010"}]),
    deployer("rail thrust contact", rail="none", thrust=3, contact=[]),
    pattern("pads.stations", stations=[]),
    pattern("pads.stations", stations="0 m"),
    pattern("pads.stations", stations=2000 * ["0 m"]),
    pattern("pads.corner", corner=["1 m"]),
    pattern("pads.normals", normals=["+y"]),
    pattern(" ".join(f"pads.{pad}.position.1" for pad in range(8)), corner=["1 kg", "1 m"]),
    pattern(" ".join(f"pads.{pad}.position.1" for pad in range(8)), corner=[True, "1 m"]),
    pattern(" ".join(f"pads.{pad}.colour" for pad in range(8)), colour="red"),
]
