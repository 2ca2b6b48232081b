"""Hertz's impact on a meshed half-space: the contact law is a result of the elements, not an input.

A quarter of the half-space is meshed, finest under the ball. The ball is rigid and the half-space
carries the compliance of both, (1 - nu^2) / E = 1 / E*, since Hertz's law depends on E* alone. The
impact is quasi-static, as in Hertz's theory: waves cross the contact thousands of times during it.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from tests.exact import contact
from tests.highfi.blocks import block
from tipoff.highfi.statics import assembly

RADIUS, MASS, SPEED, NU = 0.010, 32.882e-3, 0.1, 0.33
STIFFNESS = contact.hertz_stiffness(RADIUS, (210e9, 0.3), (72e9, NU))
MODULUS = 0.75 * STIFFNESS / RADIUS**0.5 * (1.0 - NU**2)
EXACT = contact.power_law_collision(MASS, SPEED, STIFFNESS, 1.5)
REACH = 0.4e-3  # m from the axis within which nodes may touch; the contact radius is 0.22 mm


def half_space(size, even, layers, growth=1.8):
    """Quarter block: `even` elements of `size` (m) outwards and downwards, then `layers` of them
    that grow by `growth` each."""
    edges = size * np.concatenate([np.ones(even), growth ** np.arange(1, layers + 1)])
    stations = np.concatenate([[0.0], np.cumsum(edges)])
    count = len(edges)
    even_block = block((count, count, count), (count, count, count))
    return replace(even_block, points=stations[np.round(even_block.points).astype(int)])


def surface_flexibility(mesh):
    """Places (k,2) m of the surface nodes that may touch, and their depth (k,k) m under unit forces
    on them."""
    operator = assembly.build(mesh, 1.0, MODULUS, NU, fixed=())
    x, y, z = mesh.points.T
    free = (np.stack([x > 0.0, y > 0.0, z >= 0.0], axis=1) & (z < z.max())[:, None]).ravel()
    near = np.flatnonzero((z == 0.0) & (np.hypot(x, y) < REACH))
    freedoms = (np.cumsum(free) - 1)[3 * near + 2]
    unit = np.zeros((free.sum(), near.size))
    unit[freedoms, np.arange(near.size)] = 1.0
    return mesh.points[near, :2], splu(assembly.sparse(operator)[free][:, free].tocsc()).solve(
        unit
    )[freedoms]


def ball_force(places, flexibility, approach):
    """Force (N) at an `approach` (m): no node inside the ball, no pull."""
    wanted = approach - (places**2).sum(axis=1) / (2.0 * RADIUS)
    touching = wanted > 0.0
    while True:
        force = np.zeros(len(wanted))
        force[touching] = np.linalg.solve(flexibility[np.ix_(touching, touching)], wanted[touching])
        inside = flexibility @ force < wanted - 1e-12 * approach
        following = np.where(touching, force > 0.0, inside)
        if (following == touching).all():
            return 4.0 * force.sum()
        touching = following


def impact(mesh):
    """Deepest approach (m), largest force (N) and duration (s) of the ball thrown at the meshed
    half-space."""
    places, flexibility = surface_flexibility(mesh)
    approach = np.linspace(0.0, 1.2, 61) * EXACT["penetration"]
    force = np.array([0.0] + [ball_force(places, flexibility, p) for p in approach[1:]])
    step = EXACT["duration"] / 2000
    p, speed, deepest, time = 0.0, SPEED, 0.0, 0.0
    while p >= 0.0:
        speed -= step * np.interp(p, approach, force) / MASS
        p, time = p + step * speed, time + step
        deepest = max(deepest, p)
    return {"penetration": deepest, "force": np.interp(deepest, approach, force), "duration": time}


@pytest.mark.case("O18")
@pytest.mark.parametrize(
    "size, even, layers", [(60e-6, 4, 7), pytest.param(40e-6, 6, 8, marks=pytest.mark.slow)]
)
def test_ball_on_a_meshed_half_space(size, even, layers):
    """4.83904 um, 84.9393 N, 142.426 us."""
    assert list(EXACT.values()) == pytest.approx([4.83904e-6, 84.9393, 142.426e-6], rel=5e-6)
    found = impact(half_space(size, even, layers))
    for name, value in EXACT.items():
        assert found[name] == pytest.approx(value, rel=0.05), name


@pytest.mark.case("O18")
def test_thin_block_is_no_half_space():
    """Control: the same elements on a rigid floor 0.9 mm down are too stiff."""
    assert impact(half_space(60e-6, 4, 3))["force"] > 1.05 * EXACT["force"]
