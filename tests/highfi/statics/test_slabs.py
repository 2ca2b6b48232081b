"""Products by layers that are assembled one after the other are those of a sparse factor."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from tests.highfi import sections, tets
from tests.highfi.statics.test_vibration import MATERIAL
from tests.highfi.test_compliance import beam
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.slabs import Slabs
from tipoff.mechanics.laws.mount_stiffness import MountStiffness

JOINT = MountStiffness(normal=1e13, shear=5e12)
MESHES = {
    "beam": lambda: beam((24, 2, 2)),
    "tee": lambda: sections.rail("tee", 20e-3),
    "tetrahedra": lambda: tets.split(sections.rail("tee", 20e-3)),
}


def mixed(mesh):
    """The mesh with its nodes and cells in another order."""
    generator = np.random.default_rng(3)
    order = generator.permutation(len(mesh.points))
    number = np.argsort(order)
    return replace(
        mesh,
        points=mesh.points[order],
        cells=number[mesh.cells][generator.permutation(len(mesh.cells))],
        surfaces={name: number[facets] for name, facets in mesh.surfaces.items()},
    )


@pytest.mark.parametrize("joint", [None, JOINT])
@pytest.mark.parametrize("name", MESHES)
def test_products_are_those_of_a_sparse_factor(name, joint):
    """For loads over all layers, on rigid mounts and on joints. Control: a stiffness without its joints, or
    with softer ones, has others."""
    operator = assembly.of_material(mixed(MESHES[name]()), MATERIAL, joint=joint)
    free, seen = np.repeat(operator.free, 3), []
    loads = np.random.default_rng(1).standard_normal((free.size, 4))
    found = Slabs(operator).products(loads, seen.append)
    factor = splu(csc_array(assembly.sparse(operator)[free][:, free]))
    expected = loads[free].T @ factor.solve(loads[free])
    assert len(seen) > 3 and seen == sorted(seen) and seen[-1] == 1.0
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
    if joint is not None:
        other = operator._replace(joints=0.5 * operator.joints)
        softer = Slabs(other).products(loads, lambda _: None)
        assert (np.diag(softer) > 1.01 * np.diag(expected)).all()
