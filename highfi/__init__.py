"""Finite-element reference: explicit dynamics of the flexible rail with the payload and a free
platform."""

from tipoff.highfi.compiled import compiled_effects
from tipoff.highfi.compliance import condense
from tipoff.highfi.dynamics.checkpoint import CheckpointError
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.run import prepare, run

__all__ = ["CheckpointError", "Numerics", "compiled_effects", "condense", "prepare", "run"]
