"""Made-up results of the cost study."""

from tipoff.studies.cost.results import Cost, Point

_POINT = {
    "model": "m",
    "rung": "m",
    "setting": 1e-6,
    "modes": None,
    "numerics": "-",
    "wall_s": 1.0,
    "error_deg_s": None,
    "curve_error": None,
    "integration_error_deg_s": None,
    "status": "exited",
    "reference": False,
}


def point(**given) -> Point:
    """A point with the ``given`` fields."""
    return Point(**_POINT | given)


def cost(points: list[Point], band: float | None) -> Cost:
    """A result on the condition phi15."""
    return Cost(
        condition="phi15",
        scene_hash="",
        band_deg_s=band,
        points=tuple(points),
        matched=(),
        hardware={},
    )
