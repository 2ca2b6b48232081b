"""Arrays the time loop works on: what is constant (Rail, Surface, Frame, Drive) and what evolves
(State, Active).

All places and nodal vectors are in the axes of the platform-fixed frame, whose origin is the mass
centre of the platform's *rigid part* (platform without the moving rail nodes); for a fixed platform
it is the scene origin. Nodal arrays are (n,3) with contiguous columns: one component of all nodes
after the other, as vector instructions want them.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.extruded.mesh import Pencils
from tipoff.scenes.effects.structural_damping import Damping


class Elements(NamedTuple):
    """Constant: a mesh of any shape. cells (e,k) and shape_class (e,), stiffness (c,3k,3k) N/m as
    in ``assembly.Operator``; slabs (s+1,) first element of each slab along X, of which no two with
    one between them share a node."""

    cells: np.ndarray
    shape_class: np.ndarray
    stiffness: np.ndarray
    slabs: np.ndarray


class Rail(NamedTuple):
    """Constant: points (n,3) m; mass (n,) kg; inverse_mass (n,) 1/kg, zero where clamped; clamped
    (k,) node numbers in ascending order, held (b+1,) the first of them in each block; either
    pencils, of an extruded mesh, or elements, the other one None; blocks (b+1,) first node of each
    run of nodes that is worked on at once, the nodes of a chunk of pencils; damping, None where the
    scene has none."""

    points: np.ndarray
    mass: np.ndarray
    inverse_mass: np.ndarray
    clamped: np.ndarray
    held: np.ndarray
    pencils: Pencils | None
    elements: Elements | None
    blocks: np.ndarray
    damping: Damping | None


class Groups(NamedTuple):
    """Constant: groups of pad faces of which no two can meet the same node. face (f,) group by
    group, the first of each in first_face (g+1,); clamped (w,) nodes that pads can meet, the first
    of each group in first_clamped (g+1,); first_node (g,) and first_point (g,): where the part of a
    group begins in the lists of Active."""

    face: np.ndarray
    first_face: np.ndarray
    clamped: np.ndarray
    first_clamped: np.ndarray
    first_node: np.ndarray
    first_point: np.ndarray


class Surface(NamedTuple):
    """Constant: places (n,3) m of the nodes before any load, which are the rail's points but where
    it is warm; facets (m,k) node numbers, four corners or the six nodes of a triangle; shape (q,k)
    functions at the Gauss points, and what bounds their products, ``spread`` (q,k), see ``limits``;
    area (m,q) m2 per point; for face f the facets it can meet are ``reach[first[f]:first[f+1]]``,
    sorted by their smallest X ``start`` (m); ``longest`` facet extent along X (m); control (6,6):
    control points of a triangle from its nodes, None for facets of four corners, which need none;
    border (f,4) m: smallest and largest X of the Gauss points that a face can meet, and the same
    across the rail; thickness (m) of the walls."""

    places: np.ndarray
    facets: np.ndarray
    shape: np.ndarray
    spread: np.ndarray
    area: np.ndarray
    first: np.ndarray
    reach: np.ndarray
    start: np.ndarray
    longest: float
    control: np.ndarray | None
    groups: Groups
    border: np.ndarray
    thickness: float


class Frame(NamedTuple):
    """Constant: rigid part of the free platform. mass (kg), inverse_inertia (3,3), total_mass with
    rails (kg)."""

    mass: float
    inverse_inertia: np.ndarray
    total_mass: float


class Drive(NamedTuple):
    """Constant: thrust arm behind the nominal centre (m), whether the platform takes the reaction;
    mass of the moving nodes (kg)."""

    arm: float
    reacts_on_platform: bool
    moving_mass: float


class Body(NamedTuple):
    """Evolving: a rigid body. position (3) m, velocity (3) m/s at the half step, quaternion (4),
    spin (3) angular momentum about its mass centre in inertial axes at the half step."""

    position: np.ndarray
    velocity: np.ndarray
    quaternion: np.ndarray
    spin: np.ndarray


class History(NamedTuple):
    """Evolving, with structural damping only: what one step leaves to the next. elastic (n,3) N: K
    u; displacement (n,3) m; force (n,3) N: what damping adds to the resistance; and of each block
    drag (b,6): force and moment, about the frame's origin and at the undeformed places, of the part
    proportional to mass (N, N m); loss (b,) J: energy taken over the step."""

    elastic: np.ndarray
    displacement: np.ndarray
    force: np.ndarray
    drag: np.ndarray
    loss: np.ndarray


class State(NamedTuple):
    """Evolving. displacement (n,3) m; velocity (n,3) m/s: *inertial* nodal velocity at the half
    step, resolved in frame axes; resistance (n,3) N: K u and damping minus contact, zero where
    clamped; contact (n,3) N on its way into it, else zero; turning (b,3) N m: parts of the sum of u
    x resistance before contact; clamping (b,6) parts of its force (N) and moment about the frame's
    origin (N m) on the clamped nodes; reaction (6): force and moment about the frame's origin of
    minus the resistance of all moving nodes (N, N m); motion: what nodes need of frame and gravity
    in the next drift, see MOTION; rail_momentum (3) = sum of m w and rail_moment (3) = sum of m (X
    + u) over moving nodes (kg m/s, kg m); load: see LOAD, and loads (g,LOAD_SIZE) those of each
    group of faces; work: see WORK; impulse (6) of external forces and moments about the scene
    origin (N s, N m s); face_force (f,3) N on the payload in frame axes; history, None without
    damping."""

    payload: Body
    platform: Body
    displacement: np.ndarray
    velocity: np.ndarray
    resistance: np.ndarray
    contact: np.ndarray
    turning: np.ndarray
    clamping: np.ndarray
    reaction: np.ndarray
    motion: np.ndarray
    rail_momentum: np.ndarray
    rail_moment: np.ndarray
    load: np.ndarray
    loads: np.ndarray
    work: np.ndarray
    impulse: np.ndarray
    face_force: np.ndarray
    history: History | None


class Active(NamedTuple):
    """Evolving: where contact is now. count (g,2): border points and nodes of each group in use;
    point (k,2) facet and Gauss point, face (k,) and energy (k,) J stored of loaded points near the
    border of their face; node (m,) numbers of the nodes that carry load; seen (n,) whether a node
    is among them; drag (n,3) N: their shares of the friction on the payload in frame axes;
    node_damping (n,) N s/m that friction brings to them; wait (f,) steps for which a face cannot
    touch; side (f,): whether a face was over its wall when last looked at, see OVER; struck (f,3):
    penetration (m) and X (m) of a face that struck an edge of its wall, and steps since then."""

    count: np.ndarray  # type: ignore[assignment]  # a tuple's own count() is not wanted
    point: np.ndarray
    face: np.ndarray
    energy: np.ndarray
    node: np.ndarray
    seen: np.ndarray
    drag: np.ndarray
    node_damping: np.ndarray
    wait: np.ndarray
    side: np.ndarray
    struck: np.ndarray


# Values of Active.side: in front of its wall, away from it or behind it, not looked at yet.
OVER, AWAY, UNKNOWN = 0, 1, 2
# Slots of Active.count.
BORDER, NODES = 0, 1

# Slots of State.load: contact on the payload in frame axes. GAINED is the energy (J) of points that
# came under a pressed face over its edge in this step, less that of points that left so.
(
    NORMAL_FORCE,
    FRICTION_FORCE,
    MOMENT,
    MOMENT_ON_RAIL,
    FRICTION_MOMENT,
    STORED,
    DAMPING_RATIO,
    GAINED,
) = 0, 3, 6, 9, 12, 15, 16, 17
LOAD_SIZE = 18

# Slots of State.motion, in frame axes: the frame's velocity (m/s), its turn over the step less one
# (nine numbers), its rate (rad/s), gravity (m/s2).
FRAME_VELOCITY, TURN, RATE, PULL = 0, 3, 12, 15
MOTION_SIZE = 18

# Slots of State.work (J).
(
    THRUST,
    GRAVITY,
    FRICTION,
    RELEASED,
    THRUST_AXIAL,
    GRAVITY_AXIAL,
    FRICTION_AXIAL,
    CONTACT_AXIAL,
    STRUCTURAL_DAMPING,
) = range(9)
WORK_SIZE = 9
