"""Finite-element reference: explicit dynamics of the flexible rail with the payload and a free
platform.

The names in ``__all__`` are imported at their first use: a command that needs only numbers of the
reference does not load its solver. Each import is a statement, because digests of programs follow
these.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tipoff.highfi.compliance import condense
    from tipoff.highfi.dynamics.checkpoint import CheckpointError
    from tipoff.highfi.numerics import Numerics
    from tipoff.highfi.simulation import prepare, run

__all__ = ["CheckpointError", "Numerics", "condense", "prepare", "run"]


def __getattr__(name: str) -> Any:
    module: Any
    match name:
        case "CheckpointError":
            from tipoff.highfi.dynamics import checkpoint as module
        case "Numerics":
            from tipoff.highfi import numerics as module
        case "condense":
            from tipoff.highfi import compliance as module
        case "prepare" | "run":
            from tipoff.highfi import simulation as module
        case _:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(module, name)


def __dir__() -> list[str]:
    return __all__
