"""``[flight]``."""

from tests.scenes.refusals import case
from tipoff.scenes import load


def made(change: dict):
    return load("reference").replace(change)


ONE = "one of altitude and mean_motion"
CASES = [
    case({"flight.altitude": None}, "flight", ONE),
    case({"flight.mean_motion": "1e-3 rad/s"}, "flight", ONE),
    case({"flight.range": None}, "flight.range"),
    case({"flight.range": "0 m"}, "flight.range"),
    case({"flight.height": "1 m"}, "flight.height", "no such key"),
    case({"flight.pointing_limit": "200 deg"}, "flight.pointing_limit"),
    case({"flight.body": ["1 m", "1 m"]}, "flight.body.2"),
    case(
        {"flight.envelope.0.low.0": "9 m"}, "flight.envelope.0.high", "a corner whose coordinates"
    ),
]
