"""Records of compliant contact for the kernels, with their workspace."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.memory import zeros
from tipoff.kernels.reference import by_reference
from tipoff.lowfi.contact.compliant.parts import PART_SIZE
from tipoff.mechanics import drawn_walls
from tipoff.mechanics import rail_compliance as data
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.mechanics.model import Model
from tipoff.mechanics.rail_compliance.patterns import count

# Columns of a face's lever: penetration (m) of its flat face at the middle, and its change per xi
# and eta; distance of xi on the wall ahead of xi on the pad; middle and half length, in xi, of the part
# over the wall; X (m) of the middle; distance of eta on the wall beyond eta on the pad.
DEPTH, BY_XI, BY_ETA, SHIFT, PART, SPAN, MIDDLE, ASIDE, LEVER_SIZE = range(9)


@by_reference
class Workspace(NamedTuple):
    """Workspace of one run, for f faces, p patterns of degree d, at most m faces on a rail, w = m p,
    and n modes."""

    levels: tuple  # (d+1,) degrees of the patterns (``patterns``)
    friction: np.ndarray  # (1,) coefficient of the friction that drags the walls

    lever: np.ndarray  # (f, LEVER_SIZE)
    part: np.ndarray  # (f, PART_SIZE), of the face with the patterns of the tables (``parts``)
    own: np.ndarray  # (p,) N, forces in these patterns
    displacement: np.ndarray  # (f, p) m, of the walls; the first guess of the next solution
    saved_displacement: np.ndarray  # (f, p) m, a copy
    saved_lever: np.ndarray  # (f, LEVER_SIZE), a copy
    # (f, 3, p) change of the displacement per unit of depth, tilt along and tilt across
    yielding: np.ndarray
    force: np.ndarray  # (f, p) N
    stiffness: np.ndarray  # (f, p, p) N/m, of the pressed cells: K of ``solution``
    row: np.ndarray  # (d+1,), at least 3, m: p along a row of cells, by powers of eta'
    counted: np.ndarray  # (2d+1,) sums over the pressed cells of a row: of powers of eta'
    pressed: np.ndarray  # (d+1,) m, of p times these powers
    moments: np.ndarray  # (2d+1, 2d+1) N/m, of powers of xi' and eta' over all cells
    order: np.ndarray  # (m,) numbers of the faces that are solved together
    pressing: np.ndarray  # (m,) places in ``order`` of the faces with a pressed cell
    change: np.ndarray  # (m, p) m, of the displacement of the faces in ``order``
    flexibility: np.ndarray  # (m, m, p p) m/N, between these faces
    slope: np.ndarray  # (m, m, p p) 1/N, its derivative along the rail
    matrix: np.ndarray  # (w, w)
    right: np.ndarray  # (w, 3 m + n)
    answers: np.ndarray  # (3 m, 18) to the rigid motions of the faces (``step_limit``)
    slack: np.ndarray  # (m,) m, smallest |p| of a cell of the faces in ``order``


@by_reference
class Modes(NamedTuple):
    """The n modes of each of r rails, and their displacement under each of f faces."""

    square: np.ndarray  # (r, n) 1/s2, squares of the angular frequencies
    drag: np.ndarray  # (r, n) 1/s, damping rates
    # (s-1, f, n, 4, p) 1/kg^0.5, shapes between stations, as ``Compliance.cubic``
    cubic: np.ndarray
    levels: tuple  # (d+1,) as in ``Workspace``
    # (s-1, f, n, 4, d) 1/kg^0.5 likewise, along X in the first d patterns; without stations if there is
    # no friction
    dragged: np.ndarray
    friction: np.ndarray  # (1,) that of ``Workspace``
    # (f, n, 2) 1/kg^0.5, bound of the displacement of a point under a face, by each of both
    reach: np.ndarray
    shape: np.ndarray  # (f, n, p) 1/kg^0.5, workspace: shapes S at the faces
    # (f, n, p) N/(m kg^0.5), workspace: forces by a unit of each mode on a pad at rest, no wall yielding
    pressed: np.ndarray
    offset: np.ndarray  # (f, p) m, workspace: displacement
    slope: np.ndarray  # (f, p) workspace: its derivative along the rail
    speed: np.ndarray  # (f, p) m/s, workspace: its rate


@by_reference
class ThermalOffset(NamedTuple):
    """Displacement of warm walls without load."""

    levels: tuple  # (d+1,) as in ``Workspace``
    cubic: np.ndarray  # (s-1, f, 4, p) m, between stations, as ``Compliance.cubic``
    offset: np.ndarray  # (f, p) m, workspace: value under the faces
    slope: np.ndarray  # (f, p) workspace: its derivative along the rail


@by_reference
class DrawnWalls(NamedTuple):
    """Offset of walls that are not straight as drawn (``mechanics.drawn_walls``)."""

    # (n-1, f, ACROSS, 4) m, between places along the rail, as powers of the distance (m) from the
    # place before
    cubic: np.ndarray
    spacing: float  # m, between places
    start: float  # m, X of the first place, the rear end of the rail


@by_reference
class Compliance(NamedTuple):
    """Compliant contact of f faces on r rails, with its statics at s stations."""

    # (s-1, k, 4, p p) m/N, blocks between two faces on one rail, as powers of the distance (m) from a
    # station, in the patterns of the parts of the faces over the wall (``parts``)
    cubic: np.ndarray
    # (s-1, k, 4, d d) m/N, D_res as ``cubic``, in the first d patterns for a coefficient of 1; without
    # stations if there is no friction
    dragged: np.ndarray
    block: np.ndarray  # (f, m) number of the block between a face and the m members of its rail
    turned: np.ndarray  # (f, m) whether it is this block transposed, that of an earlier face
    origin: float  # m, X of the first face at the first station
    spacing: float  # m, between stations
    members: np.ndarray  # (r, m) numbers of the faces on each rail; -1 fills up
    among: np.ndarray  # (f,) place of each face among the members of its rail
    rail: np.ndarray  # (f,) number of the rail of each face
    half: np.ndarray  # (f, 2) m, half length and half width
    ahead: np.ndarray  # (f,) m, along X from the first face to each face
    least: np.ndarray  # (f,) half length in xi of the shortest part
    across: np.ndarray  # (f,) m, place of the middle of each face across rail and normal, centred
    relief: np.ndarray  # (f,) m, of the crown at the edges
    interface_stiffness: float  # N/m3
    start: float  # m, X of the rear end of the rail
    end: float  # m, X of the open end
    node: np.ndarray  # (c,) middles of the cells in xi and eta
    crown: np.ndarray  # (c,) means of xi^4 over the cells
    modes: Modes  # none for rails without inertia
    thermal_offset: ThermalOffset  # without stations for rails that are not warm
    drawn: DrawnWalls  # without places for walls that are straight as drawn
    workspace: Workspace


def drag_of(square: np.ndarray, damping: Damping | None) -> np.ndarray:
    """Damping rates (1/s) of modes of omega^2 ``square`` (1/s2)."""
    mass_rate, stiffness_time = damping or (0.0, 0.0)
    return mass_rate + stiffness_time * square


def build(
    found: data.RailCompliance,
    model: Model,
    cells: int,
    modes: int = 0,
    damping: Damping | None = None,
) -> Compliance:
    """Record of ``found`` for the faces of ``model``, which has contact. ``modes`` of each rail
    vibrate, with the ``damping`` of the rails."""
    assert model.interface_stiffness is not None
    faces, platform = (
        model.faces,
        model.platform.mass_centre if model.platform is not None else (0.0, 0.0, 0.0),
    )
    nominal = faces.centre + np.subtract(model.payload.mass_centre, platform)
    spacing = float(found.travel[1] - found.travel[0])
    members, among = found.members.copy(), np.zeros(found.rail.size, dtype=np.int64)
    for rail in members:
        among[rail[rail >= 0]] = np.arange((rail >= 0).sum())
    edges = np.linspace(-1.0, 1.0, cells + 1)
    node, crown = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges**5) / (5.0 * np.diff(edges))
    flexibility, shape, reach = found.cubic(modes)
    rubbed = found.cubic_of_friction(modes) if model.friction is not None else None
    dragged, along, reach_along = rubbed or (_none(4), _none(5), np.zeros_like(reach))
    block, turned = found.numbered
    workspace = _workspace(faces.axis.size, members.shape[1], modes, found.degree, model)
    return Compliance(
        cubic=flexibility,
        dragged=dragged,
        block=block.copy(),
        turned=turned.copy(),
        origin=float(nominal[0, 0] + found.travel[0]),
        spacing=spacing,
        members=members,
        among=among,
        rail=found.rail.copy(),  # kernels have one type for arrays, that of the writable ones
        half=found.half.copy(),
        ahead=nominal[:, 0] - nominal[0, 0],
        least=np.ones(len(nominal)) if found.part is None else found.part[..., 1].min(axis=0),
        across=nominal[np.arange(faces.axis.size), 3 - faces.axis],
        relief=faces.relief,
        interface_stiffness=float(model.interface_stiffness),
        start=float(model.rail_start),
        end=float(model.rail_end),
        node=node,
        crown=crown,
        modes=_modes(
            found,
            (shape, along),
            np.stack([reach, reach_along], axis=-1),
            drag_of(found.frequency[:, :modes] ** 2, damping),
            workspace.friction,
        ),
        thermal_offset=_thermal_offset(found, model),
        drawn=_drawn(found, model),
        workspace=workspace,
    )


def _none(dimensions: int) -> np.ndarray:
    """An empty table with so many dimensions."""
    return zeros((0,) * dimensions)


def _thermal_offset(found: data.RailCompliance, model: Model) -> ThermalOffset:
    by_pattern = found.shape.shape[1:3]
    cubic = _none(4)
    if model.thermal is not None:
        moved = found.moved(model.thermal.amounts)
        cubic = found.cubic_of(moved).swapaxes(-1, -2).copy()
    return ThermalOffset(
        levels=tuple(range(found.degree + 1)),
        cubic=cubic,
        offset=zeros(by_pattern),
        slope=zeros(by_pattern),
    )


def _drawn(found: data.RailCompliance, model: Model) -> DrawnWalls:
    start, end = float(model.rail_start), float(model.rail_end)
    if found.drawn is None:
        return DrawnWalls(cubic=_none(4), spacing=1.0, start=start)
    places = np.linspace(start, end, len(found.drawn))
    return DrawnWalls(
        cubic=drawn_walls.cubic(places, found.drawn),
        spacing=(end - start) / (places.size - 1),
        start=start,
    )


def states(compliance: Compliance | None) -> int:
    """Number of values that the modes of ``compliance`` add to the state
    (``lowfi.state.modal_size``)."""
    return 2 * compliance.modes.square.size if compliance is not None else 0


def _modes(
    found: data.RailCompliance,
    cubics: tuple[np.ndarray, np.ndarray],
    reach: np.ndarray,
    drag: np.ndarray,
    friction: np.ndarray,
) -> Modes:
    count = drag.shape[1]
    by_pattern = found.shape.shape[1:3]
    faces, patterns = by_pattern
    return Modes(
        levels=tuple(range(found.degree + 1)),
        square=found.frequency[:, :count] ** 2,
        drag=drag,
        cubic=cubics[0],
        dragged=cubics[1],
        friction=friction,
        reach=reach,
        shape=zeros((faces, count, patterns)),
        pressed=zeros((faces, count, patterns)),
        offset=zeros(by_pattern),
        slope=zeros(by_pattern),
        speed=zeros(by_pattern),
    )


def _workspace(faces: int, members: int, modes: int, degree: int, model: Model) -> Workspace:
    patterns = count(degree)
    wide, by_pattern = members * patterns, (faces, patterns)
    return Workspace(
        levels=tuple(range(degree + 1)),
        friction=np.array([model.friction.dynamic if model.friction is not None else 0.0]),
        lever=zeros((faces, LEVER_SIZE)),
        part=zeros((faces, PART_SIZE)),
        own=zeros((patterns,)),
        displacement=zeros(by_pattern),
        saved_displacement=zeros(by_pattern),
        saved_lever=zeros((faces, LEVER_SIZE)),
        yielding=zeros((faces, 3, patterns)),
        force=zeros(by_pattern),
        stiffness=zeros((faces, patterns, patterns)),
        row=zeros((max(degree, 2) + 1,)),
        counted=zeros((2 * degree + 1,)),
        pressed=zeros((degree + 1,)),
        moments=zeros((2 * degree + 1, 2 * degree + 1)),
        order=np.zeros(members, dtype=np.int64),
        pressing=np.zeros(members, dtype=np.int64),
        change=zeros((members, patterns)),
        flexibility=zeros((members, members, patterns**2)),
        slope=zeros((members, members, patterns**2)),
        matrix=zeros((wide, wide)),
        right=zeros((wide, 3 * members + modes)),
        answers=zeros((3 * members, 18)),
        slack=zeros((members,)),
    )
