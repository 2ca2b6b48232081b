"""Forces of compliant contact on the payload, from the gradient of one potential::

    E = sum over cells of k dA max(0, p)^2 / 2 + P' F P / 2

(modes have their own potential). The forces are: P_1 against the normal, at the centre of pressure;
and along X, where the rail becomes softer or stiffer ahead::

    X = P' F' P / 2 + P' (T' + S' q)

which acts on payload and platform at the payload's mass centre, because it depends on its travel.
Two more act at the middle of the pad, because they depend on its place. One acts along X if the
wall slopes, and if the face overhangs an end, so that its part over the wall becomes shorter. One
acts across if the wall slopes::

    X = sum of pressure d(xi')/dx du/dxi' - dE/dx of the part over the wall
    Y = sum of pressure d(eta')/dy du/deta'

The place of xi' by the travel moves too: minus the first term of X acts at the mass centre. Here u
is the displacement of the wall plus its offset W as drawn, which moves with the pad along the whole
rail.
"""

from tipoff.kernels import rotation
from tipoff.kernels.jit import kernel
from tipoff.lowfi.contact.compliant import patterns, thermal_offset
from tipoff.lowfi.contact.compliant.cells import push_of_drawn_slopes, push_of_end, stored
from tipoff.lowfi.contact.compliant.modes import offset, slope
from tipoff.lowfi.contact.compliant.record import ASIDE, SHIFT
from tipoff.lowfi.contact.springs import (
    Load,
    along_width,
    friction_force,
    outward,
    pad_point,
    relative_velocity,
)


@kernel
def load(compliance, friction, platform, faces, face, body, base):
    """Load of a pressed face, after ``solve``; the velocity of the wall is neglected."""
    workspace = compliance.workspace
    force, lever, half = workspace.force[face], workspace.lever[face], compliance.half[face]
    across = along_width(faces[face], half[1] * (force[2] / force[0] - lever[ASIDE]))
    arm = rotation.rotate(
        body.turn,
        (
            faces[face, 0] + half[0] * (force[1] / force[0] - lever[SHIFT]),
            faces[face, 1] + across[1],
            faces[face, 2] + across[2],
        ),
    )
    point = (body.place[0] + arm[0], body.place[1] + arm[1], body.place[2] + arm[2])
    n, u = outward(faces[face], base), relative_velocity(platform, body, base, point)
    closing = rotation.dot(u, n)
    slip = (u[0] - closing * n[0], u[1] - closing * n[1], u[2] - closing * n[2])
    return Load(
        point=point,
        normal=(-force[0] * n[0], -force[0] * n[1], -force[0] * n[2]),
        drag=friction_force(friction, force[0], slip),
        slip=slip,
        closing=closing,
        elastic=force[0],
        raw=force[0],
    )


@kernel
def wall_force(compliance, faces, face, body, base):
    """Force (N) along the wall of a pressed face on the payload, due to the slope and the end of
    the wall, and its point of action (m), in scene axes."""
    u, force = compliance.workspace.displacement[face], compliance.workspace.force[face]
    along = _push_of_shift(compliance, face) + push_of_end(compliance, face)
    ahead, aside = push_of_drawn_slopes(compliance, face)
    along += ahead
    sideways = _work_of_slope(compliance.workspace.levels, u, force, 0, 1) + aside
    across = along_width(faces[face], sideways / compliance.half[face, 1])
    turned = rotation.rotate(base.turn, (along, across[1], across[2]))
    return turned, pad_point(faces[face], body)


@kernel
def _work_of_slope(levels, u, force, by_xi, by_eta):
    """Sum (N m) of the pressure times du/dxi' (``by_xi`` 1) or du/deta' (``by_eta`` 1)."""
    total = 0.0
    for n in range(1, len(levels)):
        for j in range(by_eta, n + 1 - by_xi):
            power = by_xi * (n - j) + by_eta * j
            lower = patterns.number(n - j - by_xi, j - by_eta)
            total += power * u[patterns.number(n - j, j)] * force[lower]
    return total


@kernel
def _push_of_shift(compliance, face):
    """Force (N) along the rail of the slope of the wall, where the pad is ahead of its place by the
    travel."""
    u, force = compliance.workspace.displacement[face], compliance.workspace.force[face]
    work = _work_of_slope(compliance.workspace.levels, u, force, 1, 0)
    return work / compliance.half[face, 0]


@kernel
def axial_force(compliance, count):
    """Force (N) along the rail of the ``count`` solved faces on the payload's mass centre."""
    workspace, pull, size = compliance.workspace, 0.0, patterns.count(compliance.workspace.levels)
    for i in range(count):
        face = workspace.order[i]
        force = workspace.force[face]
        pull -= _push_of_shift(compliance, face)
        pull += thermal_offset.axial_force(compliance.thermal_offset, face, force)
        for a in range(size):
            total = 0.0
            for j in range(count):
                other = workspace.force[workspace.order[j]]
                for b in range(size):
                    total += workspace.slope[i, j, a * size + b] * other[b]
            pull += force[a] * (0.5 * total + slope(compliance.modes, face, a))
    return pull


@kernel
def energy(compliance, count):
    """Energy (J) in rail and interface under the ``count`` solved faces: P' F P is P' (U - T - S
    q)."""
    total, size = 0.0, patterns.count(compliance.workspace.levels)
    for i in range(count):
        face = compliance.workspace.order[i]
        total += stored(compliance, face)
        for a in range(size):
            own = thermal_offset.offset(compliance.thermal_offset, face, a) + offset(
                compliance.modes, face, a
            )
            total += (
                0.5
                * compliance.workspace.force[face, a]
                * (compliance.workspace.displacement[face, a] - own)
            )
    return total
