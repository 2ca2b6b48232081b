"""Arrays the time loop works on: what is constant (Rail, Surface, Frame, Drive) and what evolves (State, Active).

All places and nodal vectors are in the axes of the platform-fixed frame, whose origin is the mass centre of the platform's
*rigid part* (platform without the moving rail nodes); for a fixed platform it is the scene origin. Nodal arrays are (n,3) with
contiguous columns: one component of all nodes after the other, as vector instructions want them.
"""

from typing import NamedTuple

import numpy as np

from highfi.pencils import Pencils


class Rail(NamedTuple):
    """Constant: points (n,3) m; mass (n,) kg; inverse_mass (n,) 1/kg, zero where clamped; clamped (k,)
    node numbers; hexes (e,8); shape_class (e,);
    stiffness (c,24,24) N/m; pencils of an extruded mesh, else None."""

    points: np.ndarray
    mass: np.ndarray
    inverse_mass: np.ndarray
    clamped: np.ndarray
    hexes: np.ndarray
    shape_class: np.ndarray
    stiffness: np.ndarray
    pencils: Pencils | None


class Surface(NamedTuple):
    """Constant: facets (m,4) node numbers; shape (q,4) bilinear functions at the Gauss points; area (m,q) m2 per point;
    for face f the facets it can meet are ``reach[first[f]:first[f+1]]``, sorted by their smallest X ``start`` (m);
    ``longest`` facet extent along X (m)."""

    facets: np.ndarray
    shape: np.ndarray
    area: np.ndarray
    first: np.ndarray
    reach: np.ndarray
    start: np.ndarray
    longest: float


class Frame(NamedTuple):
    """Constant: rigid part of the free platform. mass (kg), inverse_inertia (3,3), total_mass with rails (kg)."""

    mass: float
    inverse_inertia: np.ndarray
    total_mass: float


class Drive(NamedTuple):
    """Constant: thrust arm behind the nominal centre (m) and whether the platform takes the reaction."""

    arm: float
    reacts_on_platform: bool


class Body(NamedTuple):
    """Evolving: a rigid body. position (3) m, velocity (3) m/s at the half step, quaternion (4), spin (3) angular momentum
    about its mass centre in inertial axes at the half step."""

    position: np.ndarray
    velocity: np.ndarray
    quaternion: np.ndarray
    spin: np.ndarray


class State(NamedTuple):
    """Evolving. displacement (n,3) m; velocity (n,3) m/s: *inertial* nodal velocity at the half step, resolved in frame axes;
    resistance (n,3) N: K u minus contact, zero where clamped; rail_momentum (3) = sum of m w over moving nodes; load: see LOAD; work: see WORK; impulse (6) of external
    forces and moments about the scene origin (N s, N m s); face_force (f,3) N on the payload in frame axes."""

    payload: Body
    platform: Body
    displacement: np.ndarray
    velocity: np.ndarray
    resistance: np.ndarray
    rail_momentum: np.ndarray
    load: np.ndarray
    work: np.ndarray
    impulse: np.ndarray
    face_force: np.ndarray


class Active(NamedTuple):
    """Evolving: contact points that carry load now. count (1,); point (k,2) facet and Gauss point; face (k,);
    friction (k,3) N on the payload in frame axes; energy (k,) J stored; node_damping (n,) N s/m that friction brings to a node;
    wait (f,) steps for which a face cannot touch."""

    count: np.ndarray
    point: np.ndarray
    face: np.ndarray
    friction: np.ndarray
    energy: np.ndarray
    node_damping: np.ndarray
    wait: np.ndarray


# Slots of State.load: contact on the payload in frame axes.
NORMAL_FORCE, FRICTION_FORCE, MOMENT, MOMENT_ON_RAIL, STORED, DAMPING_RATIO = 0, 3, 6, 9, 12, 13
LOAD_SIZE = 14

# Slots of State.work (J).
THRUST, GRAVITY, FRICTION, RELEASED, THRUST_AXIAL, GRAVITY_AXIAL, FRICTION_AXIAL, CONTACT_AXIAL = range(8)
WORK_SIZE = 8
