"""Which velocity and which angular rates does a payload leave its rail with?

>>> import tipoff
>>> scene = tipoff.load("reference")
>>> tipoff.run(scene.condition("phi35")).outcome.rate  # rad/s

What stands in ``__all__`` is the way in; it is imported when it is used first. The parts behind it
are packages of their own: ``tipoff.scenes``, ``tipoff.highfi``, ``tipoff.lowfi`` and others.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.front import (
        Calibration,
        Fault,
        RailCompliance,
        Scene,
        SceneError,
        Trajectory,
        calibrate,
        catalog,
        compare,
        compliance,
        ensemble,
        load,
        parse,
        run,
    )

__all__ = [
    "Calibration",
    "Fault",
    "RailCompliance",
    "Scene",
    "SceneError",
    "Trajectory",
    "calibrate",
    "catalog",
    "compare",
    "compliance",
    "ensemble",
    "load",
    "parse",
    "run",
]


def __getattr__(name: str) -> Any:
    """A name of the front, imported now: the command answers ``--help`` without it."""
    if name in __all__:
        from tipoff import front

        return getattr(front, name)
    raise AttributeError(f"module 'tipoff' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
