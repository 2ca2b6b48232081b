"""What kernels are given of walls that give way, and the room they work in."""

from typing import NamedTuple

import numpy as np

from tipoff.kernels.memory import zeros
from tipoff.mechanics import rail_compliance as data
from tipoff.mechanics.model import Model
from tipoff.scenes.effects.friction import require_two_step
from tipoff.scenes.effects.structural_damping import Damping
from tipoff.scenes.scene import Scene

CELLS = 10  # along each edge of a pad face
# Columns of a face's lever: penetration (m) of its flat face at the middle, and per xi and eta; how
# far xi on the wall is ahead of xi on the pad, and by how much more per metre of way; X (m) of the
# middle; how far eta on the wall is beyond eta on the pad.
DEPTH, BY_XI, BY_ETA, SHIFT, DRIFT, MIDDLE, ASIDE, LEVER_SIZE = range(8)
DEGREES = 5  # of the moments of pressed cells: products of two patterns reach the fourth power


class Room(NamedTuple):
    """Scratch of one run. lever (f, LEVER_SIZE); displacement (f,p) m of the walls, the next first
    guess, and the same ``kept`` aside; force (f,p) N; moment (f, DEGREES, DEGREES) N/m; order (m,)
    faces solved for at once; and over those, w = m p: flexibility and its slope along the travel
    (w,w), matrix (w,w), right (w, 3 m + n) with n modes."""

    lever: np.ndarray
    displacement: np.ndarray
    kept: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    order: np.ndarray
    flexibility: np.ndarray
    slope: np.ndarray
    matrix: np.ndarray
    right: np.ndarray


class Modes(NamedTuple):
    """The n modes of each of r rails: square (r,n) 1/s2 of their frequencies, drag (r,n) 1/s, cubic
    (s-1,f,n,p,4) of their shapes (1/kg^0.5) as that of ``RailCompliance``; and what they are now under each
    face: shape (f,n,p), displacement ``offset`` (f,p) m, its slope along the travel (f,p), its
    speed (f,p) m/s."""

    square: np.ndarray
    drag: np.ndarray
    cubic: np.ndarray
    shape: np.ndarray
    offset: np.ndarray
    slope: np.ndarray
    speed: np.ndarray


class Warm(NamedTuple):
    """cubic (s-1,f,p,4): T (m) of warm walls between stations as powers of the way (m) from the one
    before; and as scratch its value ``place`` (f,p) m and its ``slope`` (f,p) under the faces last
    looked at."""

    cubic: np.ndarray
    place: np.ndarray
    slope: np.ndarray


class Compliance(NamedTuple):
    """cubic (s-1,f,f,p,p,4): flexibility (m/N) between stations as powers of the way (m) from the
    one before, which stand ``spacing`` apart from the X ``origin`` (m) of the first face at
    ignition on; members (r,m) faces on each rail, -1 for none; rail (f,) and half (f,2) as in
    ``mechanics.rail_compliance``; across (f,) m, where on the other axis across the rail the middle of each face
    stands that the walls were found for; relief (f,) m; penalty (N/m3); start and end (m) of the
    rail; node (n,) middle of the cells in xi and eta, and crown (n,) the means of xi^4 over them;
    warm, None where no rail is."""

    cubic: np.ndarray
    origin: float
    spacing: float
    members: np.ndarray
    rail: np.ndarray
    half: np.ndarray
    across: np.ndarray
    relief: np.ndarray
    penalty: float
    start: float
    end: float
    node: np.ndarray
    crown: np.ndarray
    modes: Modes | None
    warm: Warm | None
    room: Room


def under_pads(
    scene: Scene, model: Model, found: data.RailCompliance | None, modes: int = 0
) -> Compliance | None:
    """Record of what was ``found`` for the kernels, with so many vibrating ``modes`` of each rail;
    None without contact and for rigid ones. Raises SceneError for walls of another rail or without
    these modes, and for the law of friction that sticks."""
    if found is None or found.flexibility is None or model.contact is None:
        return None
    found.require(scene)
    require_two_step(scene)
    data.require_modes(scene.name, found, modes)
    damping = scene.rail.damping.record() if scene.rail.damping is not None else None
    return build(found, model, modes=modes, damping=damping)


def build(
    found: data.RailCompliance,
    model: Model,
    cells: int = CELLS,
    modes: int = 0,
    damping: Damping | None = None,
) -> Compliance:
    """Record of ``found`` for the faces of ``model``, which has contact; ``modes`` of each rail
    vibrate, under the ``damping`` of the rails."""
    assert model.penalty is not None
    faces, platform = (
        model.faces,
        model.platform.mass_centre if model.platform is not None else (0.0, 0.0, 0.0),
    )
    nominal = faces.centre + np.subtract(model.payload.mass_centre, platform)
    spacing = float(found.travel[1] - found.travel[0])
    rails = [np.flatnonzero(found.rail == number) for number in range(found.rail.max() + 1)]
    members = np.full((len(rails), max(rail.size for rail in rails)), -1)
    for row, rail in zip(members, rails):
        row[: rail.size] = rail
    edges = np.linspace(-1.0, 1.0, cells + 1)
    crown = np.diff(edges**5) / (5.0 * np.diff(edges))
    flexibility, shape = found.cubic(modes)
    vibrating = _modes(found, shape, damping) if shape.size else None
    return Compliance(
        flexibility,
        float(nominal[0, 0]),
        spacing,
        members,
        found.rail,
        found.half,
        nominal[np.arange(faces.axis.size), 3 - faces.axis],
        faces.relief,
        float(model.penalty),
        float(model.rail_start),
        float(model.rail_end),
        0.5 * (edges[1:] + edges[:-1]),
        crown,
        vibrating,
        _warm(found, model),
        _room(faces.axis.size, members.shape[1], shape.shape[2]),
    )


def _warm(found: data.RailCompliance, model: Model) -> Warm | None:
    if model.thermal is None:
        return None
    by_pattern = (model.faces.axis.size, data.PATTERNS)
    return Warm(
        data.cubic(found.travel, found.moved(model.thermal.amounts)),
        zeros(by_pattern),
        zeros(by_pattern),
    )


def states(compliance: Compliance | None) -> int:
    """How many numbers the modes of ``walls`` add to the state (``lowfi.state.modal_size``)."""
    return (
        2 * compliance.modes.square.size
        if compliance is not None and compliance.modes is not None
        else 0
    )


def _modes(found: data.RailCompliance, cubic: np.ndarray, damping: Damping | None) -> Modes:
    count = cubic.shape[2]
    square = found.frequency[:, :count] ** 2
    mass_rate, stiffness_time = damping or (0.0, 0.0)
    faces = (found.rail.size, data.PATTERNS)
    return Modes(
        square,
        mass_rate + stiffness_time * square,
        cubic,
        zeros((faces[0], count, faces[1])),
        *(zeros(faces) for _ in range(3)),
    )


def _room(faces: int, members: int, modes: int) -> Room:
    wide, by_pattern = members * data.PATTERNS, (faces, data.PATTERNS)
    return Room(
        zeros((faces, LEVER_SIZE)),
        zeros(by_pattern),
        zeros(by_pattern),
        zeros(by_pattern),
        zeros((faces, DEGREES, DEGREES)),
        np.zeros(members, dtype=np.int64),
        zeros((wide, wide)),
        zeros((wide, wide)),
        zeros((wide, wide)),
        zeros((wide, 3 * members + modes)),
    )
