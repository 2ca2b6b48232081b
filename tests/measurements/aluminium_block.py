"""Free vibrations of an aluminium block: the elements of the reference with nothing held.

The lumped mass and the incompatible modes are those of every rail. The frequencies of two meshes
are extrapolated with the order 2 that O13 tests.
"""

import functools

import numpy as np

from tests.highfi.blocks import block, modes
from tipoff.highfi.statics import assembly

SIZE = (11.92e-3, 10.93e-3, 9.86e-3)  # m
DENSITY = 2788.0  # kg/m3
C11, C44 = 109.26e9, 26.72e9  # Pa
COARSE, FINE = 9, 12  # elements along each edge
RIGID = 6  # motions without strain
MORE = 12  # modes beyond those asked, which may pass below them as the mesh is refined


def elastic(c11: float = C11, c44: float = C44) -> dict[str, float]:
    """Young's modulus (Pa) and Poisson's ratio of an isotropic solid of these moduli (Pa)."""
    lame = c11 - 2.0 * c44
    return {
        "youngs_modulus": c44 * (3.0 * lame + 2.0 * c44) / (lame + c44),
        "poisson_ratio": lame / (2.0 * (lame + c44)),
    }


@functools.cache
def on_mesh(elements: int, count: int) -> dict[tuple[int, ...], list[float]]:
    """Frequencies (kHz, ascending) above zero on a mesh of ``elements`` along each edge, by the
    parities of their shapes under the three mirror images of the block.

    Frequencies of different parities change places as the mesh is refined, those of one do not.
    """
    mesh = block((elements, elements, elements), SIZE)
    operator = assembly.build(mesh, DENSITY, **elastic(), fixed=())
    found, shapes = modes(operator, RIGID + count, shift=-1e10)
    order = np.argsort(found)[RIGID:]
    kept: dict[tuple[int, ...], list[float]] = {}
    for frequency, shape in zip(found[order], shapes[order]):
        grid = shape.reshape(*3 * [elements + 1], 3)
        kept.setdefault(tuple(_parity(grid, axis) for axis in range(3)), []).append(frequency / 1e3)
    return kept


def _parity(grid: np.ndarray, axis: int) -> int:
    """1 where the mirror image across ``axis`` is the shape (i,j,k,3) itself, -1 where it is the
    opposite."""
    image = np.flip(grid, axis).copy()
    image[..., axis] *= -1.0
    return int(np.sign((grid * image).sum()))


def ours(at: list[int]) -> dict[str, list[float]]:
    """Frequencies (kHz) of the modes ``at``, counted from 1."""
    coarse, fine = (on_mesh(elements, max(at) + MORE) for elements in (COARSE, FINE))
    growth = (FINE / COARSE) ** 2 - 1.0
    limits = [
        second + (second - first) / growth
        for parity, values in fine.items()
        for first, second in zip(coarse[parity], values)
    ]
    found = sorted(limits)
    return {"frequency": [found[mode - 1] for mode in at]}
