"""The mesh for the speed-up at equal accuracy: the coarsest one whose uncertainty is below the
error of the surrogate.

With settled rates r, over all axes, and U the uncertainty of the finest mesh from the three finest
(``studies.convergence``)::

    error of the surrogate           e    = max |r - r_finest|
    uncertainty of a mesh of size h  u(h) = max (U + |r_h - r_finest|)

A finer mesh makes the reference slower without need; a coarser one cannot resolve the error of the
surrogate. Where even the finest mesh is not sufficient, its speed-up is a lower bound.
"""

from collections.abc import Sequence
from typing import NamedTuple


class Mesh(NamedTuple):
    """A mesh with its ``element_size`` (m) and ``uncertainty`` (deg/s); ``sufficient``: the
    uncertainty is below the error of the surrogate."""

    element_size: float
    uncertainty: float
    sufficient: bool


def uncertainties(rates: Sequence[dict]) -> list[float] | None:
    """u(h) in deg/s of every mesh, coarsest first; None where one is unknown. Each of ``rates`` is
    one axis: ``values`` (deg/s) by mesh, and the ``uncertainty`` (deg/s) of the last."""
    if any(axis["uncertainty"] is None or None in axis["values"] for axis in rates):
        return None
    by_axis = [
        [axis["uncertainty"] + abs(value - axis["values"][-1]) for value in axis["values"]]
        for axis in rates
    ]
    return [max(found) for found in zip(*by_axis)]


def coarsest(sizes: Sequence[float], uncertainty: Sequence[float], error: float) -> Mesh:
    """The first of the meshes of falling ``sizes`` (m) with ``uncertainty`` (deg/s) below ``error``
    (deg/s), else the last."""
    meshes = [Mesh(size, value, value < error) for size, value in zip(sizes, uncertainty)]
    return next((mesh for mesh in meshes if mesh.sufficient), meshes[-1])


def sentence(found: dict) -> str:
    """The speed-up at equal accuracy, without a full stop."""
    size = f"{1e3 * found['element_size_m']:g} mm"
    mesh = (
        f"{size} is the coarsest mesh with a smaller uncertainty"
        if found["surer"]
        else f"no mesh down to {size} has a smaller uncertainty"
    )
    return (
        f"speed-up at equal accuracy on {found['condition']}: {'' if found['surer'] else 'at least '}"
        f"{found['ratio']:,.0f} times ({found['low']:,.0f} to {found['high']:,.0f} over repeats): "
        f"{found['highfi_wall_s']:.3g} s with the reference, {1e3 * found['lowfi_wall_s']:.3g} ms with "
        f"compliant contact. The error of compliant contact is {found['error_deg_s']:.2g} deg/s from "
        f"the finest mesh; {mesh} ({found['mesh_uncertainty_deg_s']:.2g} deg/s, without "
        "interface stiffness and contact cells)"
    )
