"""Rigid surrogate: payload and platform as rigid bodies, contact laws at the pad faces, adaptive
Runge-Kutta.

The names in ``__all__`` are imported at their first use, as those of ``tipoff.highfi``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.lowfi.compiled import compiled_effects
    from tipoff.lowfi.ensemble.many import run_many
    from tipoff.lowfi.numerics import Numerics
    from tipoff.lowfi.simulation import run

__all__ = ["Numerics", "compiled_effects", "run", "run_many"]

_MODULES = {
    "Numerics": "numerics",
    "compiled_effects": "compiled",
    "run": "simulation",
    "run_many": "ensemble.many",
}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
