"""Thermal displacement of the rails: the static thermo-elastic solution before ignition.

    K u = f,    f = integral B' D m e dV,    m = (1, 1, 1, 0, 0, 0),    u = s (X - X_m) at the mounts

or, if mounts are joints of stiffness S, (K + S) u = f + S s (X - X_m),

with the free strain e and the strain s of the platform of ``scenes.effects.thermal``, and the
elements of the dynamics, where e also loads the bubbles. The rails are linear. Their motion after
ignition, counted from u, is the same as that of undeformed rails without [thermal]. So the time
loop does not use u. Contact does, with walls at X + u, and so do stresses, which are D (strain - m
e). Their von Mises part does not depend on m e. They leave out the part of the bubbles due to e: at
most the stress of the temperature difference within an element, which decreases with its size.
Nodes keep their mass at X.

Source: Timoshenko and Goodier, Theory of Elasticity, 3rd ed. 1970, chapter 13.
"""

import numpy as np

from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.mechanics.laws.thermal import FIELDS, Thermal, fields
from tipoff.scenes.rail_base import MaterialTable


def displacement(
    mesh: RailMesh,
    material: MaterialTable,
    thermal: Thermal,
    joint: MountStiffness | None = None,
) -> np.ndarray:
    """Displacement (n,3) m of rails with points in scene axes on rigid mounts, or on a ``joint``.
    Raises MeshError for a rail without a mount."""
    found = np.empty_like(mesh.points)
    for nodes, rail in zip(pieces.nodes(mesh), pieces.pieces(mesh)):
        operator = assembly.of_material(rail, material, joint=joint)
        found[nodes] = (
            of_fields(rail, operator, material, Clamped(operator), thermal.middle) @ thermal.amounts
        )
    return found


def of_fields(
    mesh: RailMesh,
    operator: assembly.Operator,
    material: MaterialTable,
    clamped: Clamped,
    middle: float,
) -> np.ndarray:
    """Displacement (n,3,FIELDS) m of one rail under a unit of each field around X = ``middle``
    (m)."""
    load, held = of_each_field(mesh, operator, material, middle)
    return clamped.displaced(load, held).reshape(-1, 3, FIELDS)


def of_each_field(
    mesh: RailMesh, operator: assembly.Operator, material: MaterialTable, middle: float
) -> tuple[np.ndarray, np.ndarray]:
    """Loads (3n,FIELDS) N of a unit of each field, and the displacement (3n,FIELDS) m of the
    support of the rail."""
    strain = fields(mesh.points, middle)
    load, held = np.zeros((len(strain), 3, FIELDS)), np.zeros((len(strain), 3, FIELDS))
    # the last three are X - X_m
    load[..., :-1], held[..., -1] = loads(mesh, operator, material, strain), strain[:, 1:]
    return load.reshape(-1, FIELDS), held.reshape(-1, FIELDS)


def loads(
    mesh: RailMesh, operator: assembly.Operator, material: MaterialTable, strain: np.ndarray
) -> np.ndarray:
    """Loads f (n,3,c) N of free strains (n,c) at the nodes."""
    matrix = assembly.expansion(mesh, material.youngs_modulus, material.poisson_ratio)[
        operator.shape_class
    ]
    parts = (matrix @ strain[mesh.cells]).reshape(*mesh.cells.shape, 3, -1)
    found = np.zeros((*mesh.points.shape, strain.shape[1]))
    np.add.at(found, mesh.cells, parts)
    return found
