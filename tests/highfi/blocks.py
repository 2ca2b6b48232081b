"""Meshes and matrices the tests of this folder share."""

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh, spsolve

from tipoff.highfi.elements import hexahedron
from tipoff.highfi.mesh.rail_mesh import RailMesh, boundary_facets
from tipoff.highfi.statics import assembly

ALUMINIUM = {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33}


def block(divisions, size, stations=None) -> RailMesh:
    """Brick with one corner at the origin; surface `mount` is the face x = 0. `stations` replaces
    the grid planes along x."""
    axes = [np.linspace(0.0, length, count + 1) for length, count in zip(size, divisions)]
    if stations is not None:
        axes[0] = np.asarray(stations, dtype=float)
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape([len(axis) for axis in axes])
    corners = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
    ]
    counts = [len(axis) - 1 for axis in axes]
    hexes = np.stack(
        [
            number[tuple(slice(bit, bit + count) for bit, count in zip(corner, counts))].ravel()
            for corner in corners
        ],
        axis=1,
    )
    facets = boundary_facets(hexes)
    return RailMesh(points, hexes, {"mount": facets[(points[facets][:, :, 0] == 0.0).all(axis=1)]})


def free_stiffness(operator):
    """Stiffness of the free degrees of freedom, their masses and their mask."""
    free = np.repeat(operator.free, 3)
    return assembly.sparse(operator)[free][:, free], np.repeat(operator.mass, 3)[free], free


def static(operator, load, held):
    """Displacement (n,3) m under nodal forces `load` (n,3) N with the degrees of freedom `held`
    (n,3) at zero."""
    free = ~held.ravel()
    displacement = np.zeros(free.size)
    displacement[free] = spsolve(
        assembly.sparse(operator)[free][:, free].tocsc(), load.ravel()[free]
    )
    return displacement.reshape(-1, 3)


def without_bubbles(mesh, operator, youngs_modulus, poisson_ratio):
    """The same operator with the plain, fully integrated hexahedron, which the tests of bending use
    as their control."""
    _, representatives = assembly.shape_classes(mesh)
    strain = hexahedron.kinematics(hexahedron.basis(mesh.points[mesh.cells[representatives]]))
    law = hexahedron.elasticity(youngs_modulus, poisson_ratio)
    stress = np.einsum("cq,st,cqtj->cqsj", strain.volume, law, strain.nodal)
    stiffness = (strain.nodal.swapaxes(2, 3) @ stress).sum(axis=1)
    return operator._replace(stiffness=np.ascontiguousarray(stiffness))


def modes(operator, count, shift=0.0):
    """Lowest `count` frequencies (Hz) and shapes (count,n,3) of the free nodes, unit modal mass.

    A solid that nothing holds has a singular stiffness and needs a negative `shift` (rad2/s2). Its
    rigid motions come out on either side of zero by rounding, so the root is that of the magnitude.
    """
    stiffness, mass, free = free_stiffness(operator)
    start = np.random.default_rng(6).standard_normal(mass.size)
    squares, vectors = eigsh(
        stiffness.tocsc(), count, diags_array(mass).tocsc(), sigma=shift, v0=start
    )
    shapes = np.zeros((count, free.size))
    shapes[:, free] = vectors.T
    return np.sqrt(np.abs(squares)) / (2.0 * np.pi), shapes.reshape(count, -1, 3)


def highest_mode(operator):
    """Highest frequency (rad/s) and its shape (n,3), from a dense solution; small meshes only."""
    stiffness, mass, free = free_stiffness(operator)
    scale = 1.0 / np.sqrt(mass)
    squares, vectors = np.linalg.eigh(stiffness.toarray() * scale[:, None] * scale)
    shape = np.zeros(free.size)
    shape[free] = scale * vectors[:, -1]
    return np.sqrt(squares[-1]), shape.reshape(-1, 3)
