"""``[thermal]``, of rails that expand."""

from tests.scenes.refusals import case
from tests.scenes.support import small
from tipoff.scenes import parse

EXPANDS = {"rail__material__expansion": "23.6e-6 1/K"}


def made(change: dict):
    return parse(small(**EXPANDS | change))


def warm(keys: str, *words: str, **table):
    return case({"thermal": table}, keys, *words)


DIFFERENCE = "'degC' is not a difference: give it in K or delta_degC"
CASES = [
    warm("thermal.mean", DIFFERENCE, mean="20 degC"),
    warm("thermal.mean", "is not a difference", mean="68 degF"),
    warm("thermal.mean", "a quantity in K", mean="20 m"),
    warm("thermal.mean", "text with a unit", mean=20.0),
    warm("thermal.mean", "neither NaN nor infinite", mean="nan K"),
    warm("thermal.gradient.z", "a quantity in K/m", gradient={"z": "20 K"}),
    warm("thermal.gradient.w", "no such key", gradient={"w": "20 K/m"}),
    warm("thermal.platform_strain", "a number", platform_strain="1 mm"),
    case(
        {
            "thermal": {"mean": "20 degC", "gradient": {"x": "1 K"}, "platform_strain": "1 kg"},
            "duration": "1 m",
        },
        "duration thermal.mean thermal.gradient.x thermal.platform_strain",
    ),
    case(
        {"thermal": {"mean": "20 K"}, "rail__material__expansion": None},
        "thermal",
        "rail.material.expansion",
    ),
]
