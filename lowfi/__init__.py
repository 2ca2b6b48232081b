"""Rigid surrogate: payload and platform as rigid bodies, contact laws at the pad faces, adaptive
Runge-Kutta.

The names in ``__all__`` are imported at their first use, as those of ``tipoff.highfi``.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.lowfi.counted import evaluations
    from tipoff.lowfi.ensemble.many import run_many
    from tipoff.lowfi.numerics import OF_MANY, Numerics
    from tipoff.lowfi.simulation import run

__all__ = ["OF_MANY", "Numerics", "evaluations", "run", "run_many"]


def __getattr__(name: str) -> Any:
    module: Any
    match name:
        case "Numerics" | "OF_MANY":
            from tipoff.lowfi import numerics as module
        case "evaluations":
            from tipoff.lowfi import counted as module
        case "run":
            from tipoff.lowfi import simulation as module
        case "run_many":
            from tipoff.lowfi.ensemble import many as module
        case _:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(module, name)


def __dir__() -> list[str]:
    return __all__
