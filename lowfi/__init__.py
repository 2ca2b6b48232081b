"""Rigid surrogate: payload and platform as rigid bodies, contact laws at the pad faces, adaptive
Runge-Kutta."""

from tipoff.lowfi.compiled import compiled_effects
from tipoff.lowfi.ensemble.many import run_many
from tipoff.lowfi.numerics import Numerics
from tipoff.lowfi.run import run

__all__ = ["Numerics", "compiled_effects", "run", "run_many"]
