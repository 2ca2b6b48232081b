"""Arrays of the time loop: constant ones (Constants) and evolving ones (State, Active).

All places and nodal vectors are in the axes of the platform-fixed frame. Its origin is the mass
centre of the platform without the moving rail nodes; for a fixed platform it is the scene origin.
The *rigid part* of the platform includes the rails at rest (``dynamics.resting``), so its mass
centre then differs from the origin. Nodal arrays are (n,3) with contiguous columns: all x, then all
y, then all z, as vector instructions need them.

Sizes: n nodes, e elements, b blocks of nodes, m facets of k nodes, f pad faces, g groups of faces.
"""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.extruded.mesh import Columns
from tipoff.kernels.reference import by_reference
from tipoff.mechanics import ledger
from tipoff.mechanics.absent import Offset
from tipoff.mechanics.laws.body_force import BodyForce
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.mechanics.laws.thrust import Thrust
from tipoff.mechanics.model import Faces, Payload
from tipoff.mechanics.outcome import Milestones

# Effects whose evaluations a run counts. Mass offset, initial state and temperature have no law: they
# only change numbers.
(
    BODY_FORCE,
    CONTACT,
    FRICTION,
    HOLD_DOWN,
    PLATFORM,
    PUSHERS,
    DAMPING,
    MOUNTS,
    THRUST_OFFSET,
) = range(9)
COUNTED = (
    ledger.BODY_FORCE,
    "contact",
    "friction",
    "hold_down",
    "platform",
    "pushers",
    "rail.damping",
    "rail.mount_stiffness",
    "thrust_offset",
)


@by_reference
class Elements(NamedTuple):
    """Elements of a mesh of any shape."""

    cells: np.ndarray  # (e,k) node numbers
    shape_class: np.ndarray  # (e,) row of ``stiffness``
    stiffness: np.ndarray  # (c,3k,3k) N/m, see ``assembly.Operator``
    # (s+1,) first element of each slab along X; slabs with one between them share no node
    slabs: np.ndarray


@by_reference
class Mounts(NamedTuple):
    """Stiffness of the joints under the mounts, between m nodes and their neighbours: p pairs of
    nodes whose block is diagonal, and o others. Numbers are unsigned, because a signed index needs a
    test for negative values."""

    node: np.ndarray  # (m,) numbers of the nodes, ascending
    first_node: np.ndarray  # (b+1,) place in ``node`` of the first one of each block
    first: np.ndarray  # (m+1,) place in ``neighbour`` of the first one of each node
    neighbour: np.ndarray  # (p,) node numbers, the node itself among them
    stiffness: np.ndarray  # (p,3) N/m, diagonals
    first_mixed: np.ndarray  # (m+1,) place in ``mixed_neighbour`` of the first one of each node
    mixed_neighbour: np.ndarray  # (o,) node numbers
    mixed_stiffness: np.ndarray  # (o,3,3) N/m


@by_reference
class Rail(NamedTuple):
    """Nodes of the rails and their elasticity, which is given by columns or by elements."""

    points: np.ndarray  # (n,3) m, undeformed places
    mass: np.ndarray  # (n,) kg
    inverse_mass: np.ndarray  # (n,) 1/kg, zero where clamped
    clamped: np.ndarray  # (h,) numbers of the clamped nodes, ascending
    first_clamped: np.ndarray  # (b+1,) place in ``clamped`` of the first one of each block
    columns: Columns | None  # of an extruded mesh
    elements: Elements | None  # of any other mesh
    blocks: np.ndarray  # (b+1,) first node of each block, the nodes that are processed together
    damping: Damping
    mounts: Mounts  # without nodes: rigid mounts


@by_reference
class Groups(NamedTuple):
    """Groups of pad faces: faces of different groups never touch the same node."""

    face: np.ndarray  # (f,) numbers of the faces, group by group
    first_face: np.ndarray  # (g+1,) place in ``face`` of the first one of each group
    clamped: np.ndarray  # (w,) clamped nodes within reach of pads, group by group
    first_clamped: np.ndarray  # (g+1,) place in ``clamped`` of the first one of each group
    first_node: np.ndarray  # (g,) where the part of a group begins in ``Active.node``


@by_reference
class Search(NamedTuple):
    """Equal rectangular bins over each of w walls, seen along its normal: a bins with the facets
    over them, and e straight pieces of the walls' borders."""

    wall: np.ndarray  # (f,) number of the wall of each face, -1 without
    low: np.ndarray  # (w,2) m, least X and least place across of the bins
    per_length: np.ndarray  # (w,2) 1/m, bins along X and across
    bins: np.ndarray  # (w,2) their number along X and across
    first_bin: np.ndarray  # (w,) number of the first bin of each wall
    first_facet: np.ndarray  # (a+1,) place in ``facet`` of the first one of each bin
    facet: np.ndarray  # numbers of facets, those nearest to the middle of the bin first
    first_edge: np.ndarray  # (a+1,) place in ``edge`` of the first one of each bin
    edge: np.ndarray  # numbers of pieces of the border that a cell over the bin can overlap
    ends: np.ndarray  # (e,4) m, X and place across of both ends of each piece


@by_reference
class Surface(NamedTuple):
    """Facets of the rail walls, and the cells into which the pad faces are divided."""

    places: np.ndarray  # (n,3) m, nodes before any load: ``Rail.points`` and thermal displacement
    facets: np.ndarray  # (m,k) node numbers: four corners, or the six nodes of a triangle
    map: np.ndarray  # (m,8) from the plane of the wall into the facet, see ``contact.wall``
    quadratic: bool | None  # True: six nodes; None: four corners
    # (m,) whether a cell with its middle on the facet, or nearest to it, may overlap the border
    by_border: np.ndarray
    search: Search
    cells: np.ndarray  # (f,2) cells along the length and along the width of each face
    share: np.ndarray  # (n,) m2, area of pad that a node carries at most, see ``step_limit``
    groups: Groups
    # (f,4) m, smallest and largest X of the wall of each face, then across the rail
    border: np.ndarray
    thickness: float  # m, of the walls
    walls: np.ndarray  # numbers of the nodes of the walls that move in the frame


@by_reference
class Frame(NamedTuple):
    """Rigid part of the platform."""

    mass: float  # kg
    inverse_inertia: np.ndarray  # (3,3) 1/(kg m2), about its mass centre
    total_mass: float  # kg, with the rails
    centre: np.ndarray  # (3,) m, its mass centre from the frame's origin
    free: bool = True  # False for a fixed platform


# Of a fixed platform: it does not move, whatever acts on it.
FIXED = Frame(np.inf, np.zeros((3, 3)), np.inf, np.zeros(3), free=False)


@by_reference
class Drive(NamedTuple):
    """Action of the thrust on payload and platform."""

    arm: float  # m, from the nominal mass centre back to the point of thrust
    reacts_on_platform: bool  # whether the platform takes the reaction
    moving_mass: float  # kg, of the nodes that are stepped


@by_reference
class Exit(NamedTuple):
    """Geometry of the exit."""

    edges: np.ndarray  # (f,3) m, trailing edges of the pads in body axes
    rail_end: float  # m, X of the rail end from the frame's origin


@by_reference
class Constants(NamedTuple):
    """Constant records of a run. The kernels skip an absent effect by its record (``mechanics.absent``).
    None is a type of its own, for which kernels are compiled: a fixed platform and the elements."""

    rail: Rail
    surface: Surface
    faces: Faces
    payload: Payload
    frame: Frame  # FIXED: of a fixed platform
    drive: Drive
    thrust: Thrust  # over time
    pushers: Pushers  # thrust over travel, in frame axes from the frame's origin
    thrust_offset: Offset
    hold_down: HoldDown  # its line in frame axes from the frame's origin
    interface_stiffness: float  # N/m3, contact pressure over penetration; zero without contact
    friction: Friction
    body_force: BodyForce
    exit: Exit
    milestones: Milestones
    dt: float  # s
    substeps: int  # parts of a step divided by friction (``dynamics.substeps``); ``dt`` is one part


@by_reference
class Body(NamedTuple):
    """A rigid body."""

    position: np.ndarray  # (3,) m
    velocity: np.ndarray  # (3,) m/s at the half step
    quaternion: np.ndarray  # (4,)
    spin: np.ndarray  # (3,) kg m2/s at the half step, about the mass centre, inertial axes


@by_reference
class Motion(NamedTuple):
    """Motion of the frame that nodes need in the next drift, in frame axes."""

    velocity: np.ndarray  # (3,) m/s, of the mass centre of the rigid part
    turn: np.ndarray  # (9,) rotation of the frame over the step, less the identity
    rate: np.ndarray  # (3,) rad/s, of the frame
    acceleration: np.ndarray  # (3,) m/s2, of the body force


@by_reference
class History(NamedTuple):
    """Values that structural damping stores from one step to the next; without it, for no block."""

    elastic: np.ndarray  # (n,3) N, K u
    displacement: np.ndarray  # (n,3) m
    force: np.ndarray  # (n,3) N, contribution of damping to the resistance
    # (b,6) N and N m, resultant and moment about the frame's origin of the parts that have one:
    # proportional to mass, and of joints
    drag: np.ndarray
    loss: np.ndarray  # (b,) J, energy dissipated over the step
    mounting: np.ndarray  # (b,6) N and N m, ``State.mounting`` one step ago


@by_reference
class Inertia(NamedTuple):
    """Values of pushers with mass, and work space. A pusher at its stop has no speed: NaN."""

    # (4,n): speed (m/s) of the travel at the half step; its change (m/s) in the last kick; force (N) on
    # the pusher in the last kick; share of the next kick in which it resists other forces
    values: np.ndarray
    kept: np.ndarray  # (n,) J, kinetic energy at the end of the stroke, zero before
    matrix: np.ndarray  # (n,n)
    pairs: np.ndarray  # (n,) N s


@by_reference
class Pushing(NamedTuple):
    """Values of n spring pushers at the present places."""

    segment: np.ndarray  # (n,) number of the segment of each, -1 before the first evaluation
    travel: np.ndarray  # (n,) m
    force: np.ndarray  # (n,) N, of the springs
    friction: np.ndarray  # (n,) N, of the pushers, against the motion
    begun: np.ndarray  # (1,) J, given up from zero travel to ignition
    inertia: Inertia  # of none if no pusher has mass


@by_reference
class Stepped(NamedTuple):
    """Blocks of the rails that do not rest."""

    block: np.ndarray  # (b,) their numbers, ascending; the first ``in_use`` count
    in_use: np.ndarray  # (1,)


@by_reference
class State(NamedTuple):
    """Bodies, nodes and sums over them."""

    payload: Body
    platform: Body  # its rigid part: place and velocity of the mass centre
    stepped: Stepped
    displacement: np.ndarray  # (n,3) m
    velocity: np.ndarray  # (n,3) m/s at the half step, *inertial*, resolved in frame axes
    resistance: np.ndarray  # (n,3) N, K u and damping minus contact, zero where clamped
    contact: np.ndarray  # (n,3) N, until it is added to the resistance, then zero
    turning: np.ndarray  # (b,3) N m, sum of u x resistance before contact
    clamping: np.ndarray  # (b,6) N and N m, resistance of the clamped nodes and its moment
    mounting: np.ndarray  # (b,6) N and N m, force of the joints and its moment
    reaction: np.ndarray  # (6,) N and N m, minus the resistance of all moving nodes and its moment
    motion: Motion
    rail_momentum: np.ndarray  # (3,) kg m/s, sum of m w over the moving nodes
    rail_moment: np.ndarray  # (3,) kg m, sum of m (X + u) over the moving nodes
    load: np.ndarray  # (1,) LOAD, contact of all faces
    loads: np.ndarray  # (g,) LOAD, contact of each group
    work: np.ndarray  # (2,) WORK since ignition, see TOTAL and AXIAL
    impulse: np.ndarray  # (6,) N s and N m s, external, about the scene origin
    face_force: np.ndarray  # (f,3) N on the payload in frame axes
    face_moment: np.ndarray  # (f,3) N m, its moment about the payload's mass centre in frame axes
    guide_loads: np.ndarray  # (4,guides,LOAD_SIZE) largest loads (``mechanics.books``)
    history: History
    pushing: Pushing
    holding: np.ndarray  # (1,) N, last force of the hold-down on the payload
    sums: np.ndarray  # (SUMS_SIZE,) over nodes at the last sample, see ``dynamics.observe``
    evaluated: np.ndarray  # (c,) how often the law of each effect of ``COUNTED`` was evaluated


@by_reference
class Active(NamedTuple):
    """Present contact."""

    node_count: np.ndarray  # (g,) entries of ``node`` in use, of each group
    node: np.ndarray  # numbers of the nodes that carry load
    seen: np.ndarray  # (n,) whether a node is among them
    drag: np.ndarray  # (n,3) N, their part of the friction on the payload, frame axes
    node_damping: np.ndarray  # (n,) N s/m, damping of the nodes by friction
    wait: np.ndarray  # (f,) steps for which a face cannot touch
    side: np.ndarray  # (f,) whether a face was over its wall when last checked: OVER, AWAY, UNKNOWN
    rests: np.ndarray  # (g,) whether a rail of the group rests
    # (g,) whether a face of a group at rest may touch within two steps; the loop then returns
    near: np.ndarray
    struck: np.ndarray  # (f,) STRUCK


# Values of Active.side: in front of its wall; beside or behind it; not checked yet.
OVER, AWAY, UNKNOWN = 0, 1, 2

# Contact on the payload in frame axes.
LOAD = np.dtype(
    [
        ("normal_force", float, 3),  # N
        ("friction_force", float, 3),  # N
        ("moment", float, 3),  # N m, about the payload's mass centre
        ("moment_on_rail", float, 3),  # N m, about the frame's origin
        ("friction_moment", float, 3),  # N m, about the payload's mass centre
        ("stored", float),  # J
        ("on_walls", float),  # J, sum of u f over nodes with the resistance f; of all faces only
        ("damping_rate", float),  # 1/s, largest friction damping / mass of a node
        ("pressed", np.int64),  # cells with contact
        ("rubbed", np.int64),  # cells with friction
    ]
)

# Work (J) by the entries of the energy ledger; state entries stay zero. Rows of State.work: total,
# and axial part.
WORK = np.dtype(
    [("body_force" if name == ledger.BODY_FORCE else name, float) for name in ledger.ENTRIES]
)
TOTAL, AXIAL = 0, 1

# A face that struck an edge or the back of a wall; zero before that.
STRUCK = np.dtype(
    [
        ("depth", float),  # m
        ("x", float),  # m, of the middle of the face
        ("age", float),  # s, since then
    ]
)
