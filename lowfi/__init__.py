"""Rigid surrogate: payload and platform as rigid bodies, contact laws at the pad faces, adaptive
Runge-Kutta."""

from lowfi.compiled import compiled_effects
from lowfi.ensemble import run_many
from lowfi.numerics import Numerics
from lowfi.run import run

__all__ = ["Numerics", "compiled_effects", "run", "run_many"]
