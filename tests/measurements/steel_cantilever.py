"""Bending frequencies of a steel cantilever on a rigid clamp, by the elements of the reference."""

import numpy as np

from tests.highfi.blocks import block, modes
from tipoff.highfi.statics import assembly

SIZE = (0.759, 0.05066, 0.00514)  # m
STEEL = {"density": 7850.0, "youngs_modulus": 205e9, "poisson_ratio": 0.29}  # assumed
DIVISIONS = (60, 3, 2)


def bending() -> np.ndarray:
    """Frequencies (3,) Hz of the modes that move across the thin direction."""
    mesh = block(DIVISIONS, SIZE)
    found, shapes = modes(assembly.build(mesh, **STEEL), 8)
    share = (shapes**2).sum(axis=1)  # (mode, axis)
    flat = share[:, 2] > 0.5 * share.sum(axis=1)
    bent = np.abs(shapes[:, :, 2].mean(axis=1)) > 1e-3 * np.abs(shapes[:, :, 2]).max(axis=1)
    return found[flat & bent][:3]


def ours(at: list[int]) -> dict[str, list[float]]:
    """Frequencies (Hz) of the bending modes ``at``, counted from 1, and their ratios to the
    first."""
    found = bending()
    return {
        "frequency": [float(found[mode - 1]) for mode in at],
        "ratio to the first": [float(found[mode - 1] / found[0]) for mode in at],
    }
