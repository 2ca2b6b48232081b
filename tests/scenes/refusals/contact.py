"""``[contact]`` with its pad layer, and ``[friction]``."""

from tests.scenes.refusals import case
from tests.scenes.support import CONTACT, FRICTION, STICKING, small
from tipoff.scenes import parse


def made(change: dict):
    return parse(small(**change))


def contact(keys: str, **changed):
    return case({"contact": CONTACT | changed}, keys)


def friction(keys: str, table: dict = STICKING, **changed):
    return case({"friction": table | changed}, keys)


LAYER = {"thickness": "0 mm", "youngs_modulus": "5 mm", "poisson_ratio": 0.5, "colour": "red"}
PAD_LAYER = "contact.pad_layer"
CASES = [
    case({"contact": {}}, "contact.law"),
    contact("contact.law", law="hertz"),
    contact("contact.stiffness", exponent=2.0),
    contact("contact.exponent", exponent="x"),
    contact("contact.exponent", exponent=0.01),
    contact("contact.clearance", clearance="1e10 m"),
    contact(" ".join(f"{PAD_LAYER}.{key}" for key in LAYER), pad_layer=LAYER),
    contact(f"{PAD_LAYER}.thickness {PAD_LAYER}.youngs_modulus", pad_layer={}),
    case({"friction": {}}, " ".join(f"friction.{key}" for key in FRICTION)),
    friction("friction.law", FRICTION, law="sticky"),
    friction("friction.dynamic", dynamic=0.5),
    friction("friction.static_speed", static_speed="1 mm/s"),
    friction("friction.stiffness", stiffness="1 N/mm**2"),
    friction("friction.capture_speed", capture_speed="0.1 nm/s"),
]
