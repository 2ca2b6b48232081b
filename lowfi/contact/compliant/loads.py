"""Forces of compliant contact on the payload, from the gradient of one potential::

    E = sum over cells of k dA max(0, p)^2 / 2 + P' F P / 2

(modes have a potential of their own). They are: P_1 against the normal, at the centre of pressure;
and along X, where the rail is softer or stiffer ahead and where its bent wall slopes (xi' moves
with the pad where a face overhangs an end)::

    X = P' F' P / 2 + P' (T' + W' q) + sum of pressure d(xi')/dx du/dxi'

which acts on payload and platform at the payload's mass centre, whose travel it belongs to. Where
the pad moves across the rail, eta' moves with its middle, and the slope of the wall pushes::

    Y = sum of pressure d(eta')/dy du/deta'

Energy still under the part of a pad that leaves the wall is lost.
"""

from tipoff.kernels import rotation
from tipoff.kernels.jit import inlined, kernel
from tipoff.lowfi.contact.compliant import thermal_offset
from tipoff.lowfi.contact.compliant.cells import stored
from tipoff.lowfi.contact.compliant.modes import offset, slope
from tipoff.lowfi.contact.compliant.record import ASIDE, DRIFT, SHIFT
from tipoff.lowfi.contact.springs import (
    Load,
    along_width,
    friction_force,
    outward,
    pad_point,
    relative_velocity,
)
from tipoff.mechanics.rail_compliance import PATTERNS


@kernel
def load(compliance, friction, platform, faces, face, body, base):
    """Load of a pressed face, after ``solve``; the velocity of the wall itself is neglected."""
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
        point,
        (-force[0] * n[0], -force[0] * n[1], -force[0] * n[2]),
        friction_force(friction, force[0], slip),
        slip,
        closing,
        force[0],
        force[0],
    )


@inlined
def side_force(compliance, faces, face, body, base):
    """Force (N) across the rail on the payload by the slope of the wall under a pressed face, and
    where it acts (m), in scene axes."""
    u, force = compliance.workspace.displacement[face], compliance.workspace.force[face]
    size = (u[2] * force[0] + u[4] * force[1] + 2.0 * u[5] * force[2]) / compliance.half[face, 1]
    return rotation.rotate(base.turn, along_width(faces[face], size)), pad_point(faces[face], body)


@kernel
def axial_force(compliance, count):
    """Force (N) along the rail on the payload by the ``count`` faces solved for, and the energy lost
    per metre of travel (J/m)."""
    workspace, pull, fading = compliance.workspace, 0.0, 0.0
    for i in range(count):
        face = workspace.order[i]
        u, force = workspace.displacement[face], workspace.force[face]
        pull += workspace.lever[face, DRIFT] * (
            u[1] * force[0] + 2.0 * u[3] * force[1] + u[4] * force[2]
        )
        pull += thermal_offset.axial_force(compliance.thermal_offset, face, force)
        if workspace.lever[face, DRIFT] != 0.0:  # else all of it is over the wall
            fading += stored(compliance, face)[1]
        for a in range(PATTERNS):
            total = 0.0
            for j in range(count):
                for b in range(PATTERNS):
                    total += (
                        workspace.slope[i * PATTERNS + a, j * PATTERNS + b]
                        * workspace.force[workspace.order[j], b]
                    )
            pull += force[a] * (0.5 * total + slope(compliance.modes, face, a))
    return pull, fading


@kernel
def energy(compliance, count):
    """Energy (J) in rail and interface under the ``count`` faces solved for: P' F P is P' (U - T -
    W q)."""
    total = 0.0
    for i in range(count):
        face = compliance.workspace.order[i]
        total += stored(compliance, face)[0]
        for a in range(PATTERNS):
            own = thermal_offset.offset(compliance.thermal_offset, face, a) + offset(
                compliance.modes, face, a
            )
            total += (
                0.5
                * compliance.workspace.force[face, a]
                * (compliance.workspace.displacement[face, a] - own)
            )
    return total
