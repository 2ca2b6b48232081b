"""Finite-element reference: explicit dynamics of the flexible rail with the payload and a free
platform."""

from highfi.checkpoint import CheckpointError
from highfi.compiled import compiled_effects
from highfi.compliance import walls
from highfi.numerics import Numerics
from highfi.run import prepare, run

__all__ = ["CheckpointError", "Numerics", "compiled_effects", "prepare", "run", "walls"]
