"""Rigid surrogate: payload and platform as rigid bodies, contact laws at the pad faces, adaptive Runge-Kutta."""

from lowfi.numerics import Numerics
from lowfi.run import run

__all__ = ["Numerics", "run"]
