"""Predicts the velocity and the angular rates of a payload when it leaves its rail.

>>> import tipoff
>>> scene = tipoff.load("tiny")  # a small one; "reference" is the one of the documentation
>>> run = tipoff.run(scene.condition("phi15"), "springs")
>>> len(run.outcome.rate)  # settled body rates, rad/s
3

The names in ``__all__`` are imported at their first use. The packages behind them are
``tipoff.scenes``, ``tipoff.highfi``, ``tipoff.lowfi`` and others.
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
        scene_from_rocketpy,
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
    "scene_from_rocketpy",
]


def __getattr__(name: str) -> Any:
    """Import a name of ``tipoff.front`` at its first use, so that ``--help`` is fast."""
    if name in __all__:
        from tipoff import front

        return getattr(front, name)
    raise AttributeError(f"module 'tipoff' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
