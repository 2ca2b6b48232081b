"""The mesh to measure a speed-up against: the coarsest one that is surer of its answer than the
surrogate is exact.

With settled rates r, over all axes, and U what the three finest meshes leave open at the finest
(``studies.convergence``)::

    error of the surrogate           e    = max |r - r_finest|
    uncertainty of a mesh of size h  u(h) = max (U + |r_h - r_finest|)

A finer mesh than that would make the reference slow for digits that nobody compares, a coarser one
could not tell how wrong the surrogate is. Where even the finest is not surer, a mesh that is takes
longer still.
"""

from collections.abc import Sequence
from typing import NamedTuple


class Mesh(NamedTuple):
    """Its ``element_size`` (m), its ``uncertainty`` (deg/s), and whether that is less than the
    surrogate's error."""

    element_size: float
    uncertainty: float
    surer: bool


def uncertainties(rates: Sequence[dict]) -> list[float] | None:
    """u(h) in deg/s of every mesh, coarsest first; None where it is not known of all. Each of
    ``rates`` is one axis: ``values`` (deg/s) by mesh, and the ``uncertainty`` (deg/s) of the
    last."""
    if any(axis["uncertainty"] is None or None in axis["values"] for axis in rates):
        return None
    by_axis = [
        [axis["uncertainty"] + abs(value - axis["values"][-1]) for value in axis["values"]]
        for axis in rates
    ]
    return [max(found) for found in zip(*by_axis)]


def coarsest(sizes: Sequence[float], uncertain: Sequence[float], error: float) -> Mesh:
    """The first of the meshes of falling ``sizes`` (m) with ``uncertain`` (deg/s) below ``error``
    (deg/s), else the last."""
    meshes = [Mesh(size, open_, open_ < error) for size, open_ in zip(sizes, uncertain)]
    return next((mesh for mesh in meshes if mesh.surer), meshes[-1])


def sentence(found: dict) -> str:
    """The speed-up in words."""
    size, wall = f"{1e3 * found['element_size_m']:g} mm", f"{found['highfi_wall_s']:.3g} s"
    known = (
        f"({found['mesh_uncertainty_deg_s']:.2g} by all meshes; penalty and quadrature not counted)"
    )
    mesh = (
        f"{size} is the coarsest mesh whose discretisation error is smaller {known}"
        if found["surer"]
        else f"no mesh down to {size} has a smaller discretisation error {known}"
    )
    least = "" if found["surer"] else "at least "
    ratio = f"{least}{found['ratio']:,.0f} times ({found['low']:,.0f} to {found['high']:,.0f})"
    return (
        f"speed at equal accuracy on {found['condition']}: on compliant contact the surrogate is "
        f"within "
        f"{found['error_deg_s']:.2g} deg/s of the finest mesh, and {mesh}; {ratio}, {wall} against "
        f"{1e3 * found['lowfi_wall_s']:.3g} ms, timed in one go"
    )
