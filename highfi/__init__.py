"""Finite-element reference: explicit dynamics of the flexible rail with the payload and a free
platform.

The names in ``__all__`` are imported at their first use: a command that needs only numbers of the
reference does not load its solver.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.highfi.compiled import compiled_effects
    from tipoff.highfi.compliance import condense
    from tipoff.highfi.dynamics.checkpoint import CheckpointError
    from tipoff.highfi.numerics import Numerics
    from tipoff.highfi.simulation import prepare, run

__all__ = ["CheckpointError", "Numerics", "compiled_effects", "condense", "prepare", "run"]

_MODULES = {
    "CheckpointError": "dynamics.checkpoint",
    "Numerics": "numerics",
    "compiled_effects": "compiled",
    "condense": "compliance",
    "prepare": "simulation",
    "run": "simulation",
}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
