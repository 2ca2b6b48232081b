"""Groups of pad faces that threads may treat at the same time: no node belongs to two of them."""

import numpy as np

from tests.highfi.support import reachable, tiny
from tipoff import highfi
from tipoff.highfi import Numerics
from tipoff.highfi.contact.surface import group_faces
from tipoff.highfi.dynamics.system import build

NUMERICS = Numerics(element_size=0.008)


def system():
    scene = tiny()
    return build(scene, NUMERICS, highfi.prepare(scene, NUMERICS))


def nodes_of(surface, group):
    """Nodes that the faces of a group can meet."""
    groups = surface.groups
    faces = groups.face[groups.first_face[group] : groups.first_face[group + 1]]
    return np.unique(
        np.concatenate([surface.facets[reachable(surface, face)].ravel() for face in faces])
    )


def test_each_rail_has_a_group_of_its_own():
    found = system()
    groups = found.surface.groups
    assert np.diff(groups.first_face).tolist() == [4, 4, 4, 4]
    assert sorted(groups.face.tolist()) == list(range(16))
    sides = [
        {tuple(np.sign(found.rail.points[node, 1:])) for node in nodes_of(found.surface, group)}
        for group in range(4)
    ]
    assert all(len(side) == 1 for side in sides) and len(set.union(*sides)) == 4


def test_no_node_belongs_to_two_groups():
    surface = system().surface
    nodes = [nodes_of(surface, group) for group in range(4)]
    assert np.concatenate(nodes).size == np.unique(np.concatenate(nodes)).size
    assert np.diff(surface.groups.first_node).tolist() == [part.size for part in nodes[:-1]]


def test_faces_that_share_a_node_are_in_one_group():
    """Faces 0 and 4 share no node, but each shares one with face 2; face 3 can meet no node."""
    nodes = [np.array(part, dtype=np.int64) for part in ([1, 2], [3, 9], [2, 5], [], [5, 7])]
    found = group_faces(nodes, clamped=np.array([3, 4, 7]))
    assert found.face.tolist() == [0, 2, 4, 1, 3] and found.first_face.tolist() == [0, 3, 4, 5]
    assert found.first_node.tolist() == [0, 4, 6]
    assert found.clamped.tolist() == [7, 3] and found.first_clamped.tolist() == [0, 1, 2, 2]
