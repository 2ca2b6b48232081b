"""Static deflection of a rail whose mounts are accelerated.

Every point X (m) of the platform has the acceleration a(X) = b + G X, with b in m/s2 and G, from
angular acceleration and centrifugal terms, in 1/s2. If it changes slowly in a period of the rail,
the rail follows as in statics::

    K u = -M a(X)

So u is linear in the twelve numbers of b and G: one factorisation of K and twelve loads are
sufficient. The mirror image of a rail, with the signs S, has u'(SX) = S u(X) with b' = S b and
G' = S G S.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes.rail_base import MaterialTable

TERMS = 12  # b, then G row by row


class Deflection(NamedTuple):
    """Static deflection of one solid with n nodes."""

    own: np.ndarray  # (n,) its nodes in the mesh
    shapes: np.ndarray  # (TERMS, n, 3) m for a unit of each term, of the solid that it mirrors
    signs: np.ndarray  # (3,) S
    # (TERMS,) m, largest deflection across the rail of a wall that pads can touch, for each term
    size: np.ndarray
    # (TERMS,) rad/s, frequency by Rayleigh's quotient of each shape; zero without deflection
    frequency: np.ndarray

    def under(self, terms: np.ndarray) -> np.ndarray:
        """Displacement (n,3) m under ``terms`` (TERMS,)."""
        return np.tensordot(self.mirrored() * terms, self.shapes, axes=1) * self.signs

    def mirrored(self) -> np.ndarray:
        """Signs (TERMS,) that convert terms of this solid to those of the solid that it mirrors."""
        return np.concatenate([self.signs, np.outer(self.signs, self.signs).ravel()])


@lru_cache(maxsize=4)  # runs on one rail share them
def deflections(
    mesh: RailMesh, material: MaterialTable, joint: MountStiffness | None, most: int
) -> tuple[Deflection, ...] | None:
    """Static deflection of each solid of ``mesh`` on rigid mounts or on a ``joint``; None if a
    solid has no mount or more than ``most`` nodes."""
    found: list[tuple[RailMesh, Deflection]] = []
    for own, solid in zip(pieces.nodes(mesh), pieces.pieces(mesh)):
        if not solid.surfaces["mount"].size or own.size > most:
            return None
        for first, known in found:
            if (signs := pieces.mirror(first, solid)) is not None:
                found.append((solid, known._replace(own=own, signs=known.signs * signs)))
                break
        else:
            found.append((solid, _solve(solid, own, material, joint)))
    return tuple(deflection for _, deflection in found)


def _solve(
    solid: RailMesh, own: np.ndarray, material: MaterialTable, joint: MountStiffness | None
) -> Deflection:
    operator = assembly.of_material(solid, material, joint=joint)
    count = own.size
    shapes, size, frequency = (
        np.zeros((TERMS, count, 3)),
        np.zeros(TERMS),
        np.zeros(TERMS),
    )
    if operator.free.any():
        clamped = Clamped(operator)
        amounts = np.concatenate([np.ones((1, count)), solid.points.T])
        loads = np.zeros((TERMS, count, 3))
        for i in range(3):
            loads[i, :, i] = -operator.mass
            loads[3 + 3 * i : 6 + 3 * i, :, i] = -operator.mass * amounts[1:]
        flat = loads.reshape(TERMS, -1)[:, clamped.free]
        moved = clamped.solve(np.ascontiguousarray(flat.T)).T
        shapes.reshape(TERMS, -1)[:, clamped.free] = moved
        mass = np.repeat(operator.mass, 3)[clamped.free]
        walls = [group for name, group in solid.surfaces.items() if name.startswith("contact")]
        touched = np.unique(np.concatenate(walls)) if walls else np.zeros(0, dtype=np.int64)
        size = np.linalg.norm(shapes[:, touched, 1:], axis=2).max(axis=1, initial=0.0)
        work, inertia = (moved * flat).sum(axis=1), (moved**2 * mass).sum(axis=1)
        squared = np.divide(work, inertia, out=np.zeros(TERMS), where=inertia > 0.0)
        frequency = np.sqrt(squared)
    return Deflection(own=own, shapes=shapes, signs=np.ones(3), size=size, frequency=frequency)
