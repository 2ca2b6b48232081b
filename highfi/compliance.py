"""Compliance of the rail walls along the path of the pads, from the stiffness of the reference.

    C_iajb = 1/(A_i A_j) integral over faces i and j of phi_a n_i . K^-1 . n_j phi_b
    F_ij = G_i^-1 C_ij G_j^-1,   G_i = 1/A_i integral phi_a phi_b dA

C is the mean displacement of the wall under pad face i, weighted with pattern a, under a unit force
with the pressure pattern b on face j. F is the flexibility of ``mechanics.rail_compliance``:
displacement and pressure are both approximated by the polynomials phi. K is the stiffness of the
whole rail, held at its mounts, so a face also displaces the walls of the other faces on its rail.
Inertia is left out. Both matrices are symmetric (Maxwell and Betti). [thermal] is a sum of fields
of temperature; the thermal displacement of the same walls (``statics.thermal``) is computed for a
unit of each field.

The modes psi_m of the same rail (``statics.vibration``) are averaged under the faces with the same
patterns, so that a full set of them gives C::

    V_iam = 1/A_i integral over face i of phi_a n_i . psi_m,   W = G^-1 V,   C = sum_m V_m V_m' / omega_m^2
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail import drawn_walls, inputs, nodal
from tipoff.highfi.rail.places import Patches, one_of, part_of_wall, pressed_together
from tipoff.highfi.simulation import prepare
from tipoff.highfi.statics import joint_terms
from tipoff.highfi.statics.held import HeldRail, distinct
from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.model import Faces, half_sizes
from tipoff.mechanics.rail_compliance import (
    DEGREE,
    MODES,
    MOST_DEGREE,
    PATTERNS,
    RailCompliance,
    on_part,
    pairs,
)
from tipoff.mechanics.rail_compliance import patterns as of_degree
from tipoff.mechanics.rail_compliance.joint_terms import JointTerms
from tipoff.mechanics.rail_compliance.patterns import DRAGGED, FARTHEST
from tipoff.scenes import scene_model
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.scene import Scene

_SPACING = 2e-3  # m between stations; over an end, compliance changes within a quarter of a pad
# of the largest eigenvalue of G; below it, patterns hardly differ on the wall that a face covers
_SINGULAR = 1e-6


class Compliance(NamedTuple):
    """Compliance at s stations between f pad faces with p patterns each, and n modes of r rails.
    Near an end of the rail, xi runs over the ``part`` of a face that has a wall."""

    travel: np.ndarray  # (s,) m of the payload along X since ignition
    # (s,f,m,p,p+d) m/N between faces on one rail (``mechanics.rail_compliance.pairs``): p columns
    # under pressures, d under tractions along X
    near: np.ndarray
    gram: np.ndarray  # (s,f,p,p), zero where a face has no wall
    # (s,f,2) middle and half length, in xi of the whole face, of the part that has a wall
    part: np.ndarray
    rail: np.ndarray  # (f,) number of the rail under each face, -1 without
    half: (
        np.ndarray
    )  # (f,2) m, half size along xi and eta, negative where eta runs against the axis
    frequency: np.ndarray  # (r,n) rad/s
    swung: np.ndarray  # (s,f,p+d,n) 1/kg^0.5, in the modes: V, then along X in d patterns
    # (s,f,p,t) m, mean displacement away from the payload by a unit of each of the t thermal fields
    warm: np.ndarray
    joints: JointTerms | None  # of rails on joints, if requested

    @property
    def matrix(self) -> np.ndarray:
        """Mean displacements (s,f,p,f,p) m/N under pressures, of all faces."""
        return pairs.whole(self.near[..., : self.gram.shape[-1]], self.rail)

    @property
    def shape(self) -> np.ndarray:
        """V (s,f,p,n) 1/kg^0.5."""
        return self.swung[:, :, : self.gram.shape[-1]]

    @property
    def dragged(self) -> np.ndarray:
        """Mean displacements (s,f,p,f,d) m/N under tractions along X, of all faces."""
        return pairs.whole(self.near[..., self.gram.shape[-1] :], self.rail)


def condense(
    scene: Scene,
    element_size: float,
    spacing: float | None = None,
    modes: int = MODES,
    held: Sequence[HeldRail] | None = None,
    degree: int = DEGREE,
    joints: bool = False,
) -> RailCompliance:
    """Flexibility and lowest ``modes`` of the rails of ``scene`` in elements of about
    ``element_size`` (m), at stations about ``spacing`` (m) apart (None: ``spacing_of``), from half a
    pad before ignition until the last pad has left by half a pad, for patterns of this ``degree``.
    With ``joints`` it holds the terms for any factor on the stiffness of the mounts; their time grows
    with the square of the rail's length. With ``rails(scene, element_size)`` as ``held``, their
    factors can be used again.

    Raises SceneError or MeshError.
    """
    scene = inputs.nominal(scene)
    stations = _stations(scene, spacing or spacing_of(scene))
    own = inputs.of_scene(scene)
    held = held or rails(scene, element_size)
    count = of_degree.count(degree)
    placed = _placed(held, own.faces, own.reach, stations, count, DRAGGED)
    if not joints and (known := _by_nodes(scene, placed, modes)):
        return replace(known, drawn=_drawn(scene, element_size))
    found = _solved(placed, modes, joints)
    inverse, first = _inverses(found.gram, found.part, degree)
    pressed, rubbed = found.near[..., :count], found.near[..., :DRAGGED, count:]
    dragged = pairs.on_both_sides(first, rubbed, found.rail)
    warm = np.einsum("siab,sibt->tsia", inverse, found.warm)
    return RailCompliance(
        travel=stations,
        flexibility=pairs.on_both_sides(inverse, pressed, found.rail),
        rail=found.rail,
        half=found.half,
        frequency=found.frequency,
        shape=inverse @ found.shape,
        made_for=digest(scene),
        part=found.part,
        warm=warm,
        joints=found.joints
        and found.joints._replace(
            moved=inverse @ found.joints.moved,
            moved_first=first @ found.joints.moved_first,
            moved_by_friction=first @ found.joints.moved_by_friction,
            shape=inverse @ found.joints.shape,
            dragged_shape=first @ found.joints.dragged_shape,
        ),
        drawn=_drawn(scene, element_size),
        dragged=0.5 * (dragged + pairs.transposed(dragged, found.rail)),
        dragged_shape=first @ found.swung[:, :, count:],
    )


def _inverses(gram: np.ndarray, part: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Matrices (s,f,p,p) from mean displacements to patterns of whole faces, for all patterns and for
    those that friction drags; ``gram`` and ``part`` as in ``Compliance``."""
    inverse = np.linalg.pinv(gram, rcond=_SINGULAR, hermitian=True)
    middle, size = part[..., 0], part[..., 1]
    place = np.stack([-middle, np.ones_like(size)], axis=-1) / size[..., None]
    whole = on_part(place, degree).swapaxes(-1, -2)
    first = np.linalg.pinv(gram[..., :DRAGGED, :DRAGGED], rcond=_SINGULAR, hermitian=True)
    return whole @ inverse, whole[..., :DRAGGED, :DRAGGED] @ first


def _by_nodes(scene: Scene, placed: "_Placed", modes: int) -> RailCompliance | None:
    """The compliance of a long rail from that of the nodes under its pads; None for other rails."""
    if len(placed.under) != 1:
        return None
    rail, patches, places = placed.under[0]
    inverses = _inverses(placed.gram, placed.part, of_degree.degree_of(placed.gram.shape[-1]))
    found = nodal.under_patches(rail, patches, places, inverses, placed.middle, modes)
    if found is None:
        return None
    nodes, frequency = found
    return RailCompliance(
        travel=placed.travel,
        rail=placed.rail,
        half=placed.half,
        frequency=np.tile(frequency, (placed.rail.max() + 1, 1)),
        made_for=digest(scene),
        part=placed.part,
        nodes=nodes,
        **nodes.tables(placed.rail)._asdict(),
    )


def spacing_of(scene: Scene) -> float:
    """Distance (m) of stations: in proportion to elements that are stretched along the rail, up to half
    of the shortest pad, over which the compliance changes at an end."""
    most = 0.5 * min(pad.length for pad in scene.pads)
    return max(_SPACING, min(_SPACING * getattr(scene.rail, "stretch", 1.0), most))


def _stations(scene: Scene, spacing: float) -> np.ndarray:
    own = inputs.of_scene(scene)
    half, middle = own.faces.half_length, own.faces.centre[:, 0]
    first, last = -half.max(), (own.reach[1] + 2.0 * half - middle).max()
    return np.linspace(first, last, int(np.ceil((last - first) / spacing - 1e-9)) + 1)


def _drawn(scene: Scene, element_size: float) -> np.ndarray | None:
    """Offset (n,f,3) m of the walls of a file from straight walls, None if they are straight.
    Raises SceneError or MeshError."""
    if scene.rail.IS_STRAIGHT:
        return None
    own = inputs.of_scene(scene)
    mesh = prepare(scene, Numerics(element_size=element_size))
    half = half_sizes(own.faces)[:, 1]
    return drawn_walls.offsets(mesh, own.faces, half, own.reach)


def walls(scene: Scene, element_size: float, spacing: float | None = None) -> RailCompliance | None:
    """Rigid walls of ``scene`` with their offset as drawn, without temperatures, at stations about
    ``spacing`` (m) apart; None for sections and for straight walls. Statics are not
    solved. The element size (m) matters only for a solid with curved walls. Raises SceneError or
    MeshError."""
    if scene.rail.IS_STRAIGHT:
        return None
    drawn = _drawn(scene, element_size)
    stations = _stations(scene, spacing or spacing_of(scene))
    nominal = scene_model.built(scene).nominal
    faces = nominal.axis.size
    return RailCompliance(
        travel=stations,
        flexibility=None,
        rail=np.zeros(faces, dtype=np.int64),
        half=half_sizes(nominal),
        frequency=np.zeros((1, 0)),
        shape=np.zeros((stations.size, faces, PATTERNS, 0)),
        made_for=digest(scene),
        drawn=drawn,
    )


def rails(scene: Scene, element_size: float) -> list[HeldRail]:
    """The distinct rails of ``scene`` in elements of about ``element_size`` (m) on their mounts, with
    a factor of 1 on the stiffness of these. Raises SceneError or MeshError."""
    return _held(inputs.nominal(scene), element_size)


def _held(scene: Scene, element_size: float) -> list[HeldRail]:
    own = inputs.of_scene(scene)
    mesh = prepare(scene, Numerics(element_size=element_size))
    return distinct(mesh, own.material, own.joint)


def along(
    scene: Scene,
    element_size: float,
    travel: Sequence[float] | np.ndarray,
    patterns: int = PATTERNS,
    modes: int = 0,
    dragged: int = 0,
) -> Compliance:
    """Compliance of the rails of ``scene`` in elements of about ``element_size`` (m), the payload
    aligned and moved by each ``travel`` (m) from its place at ignition.

    Faces are those of ``mechanics.model.Faces``. Raises SceneError, MeshError, and ValueError for
    an unavailable number of patterns or modes.
    """
    own, held = inputs.of_scene(scene), _held(scene, element_size)
    return of_rails(held, own.faces, own.reach, travel, patterns, modes, dragged)


def of_rails(
    held: Sequence[HeldRail],
    faces: Faces,
    reach: tuple[float, float],
    travel: Sequence[float] | np.ndarray,
    patterns: int = PATTERNS,
    modes: int = 0,
    dragged: int = 0,
    joints: bool = False,
) -> Compliance:
    """As ``along``, for ``held`` rails whose points are in the axes of ``faces.centre`` and
    ``faces.wall``, between the X (m) of ``reach``. Friction
    drags the first ``dragged`` of the patterns. With ``joints`` and modes, the terms of
    joints are computed.

    Raises MeshError for a rail under a face without a mount, ValueError for an unavailable number
    of patterns or modes.
    """
    if not 1 <= patterns <= (most := of_degree.count(MOST_DEGREE)):
        raise ValueError(f"patterns: given {patterns!r}, expected 1 to {most}")
    stations = np.asarray(travel, dtype=float)
    return _solved(_placed(held, faces, reach, stations, patterns, dragged), modes, joints)


class _Placed(NamedTuple):
    """Faces at stations on their rails; arrays as in ``Compliance``."""

    travel: np.ndarray
    gram: np.ndarray
    part: np.ndarray
    rail: np.ndarray
    half: np.ndarray
    # rails under a face, with their places (s,f) under the faces of each of their images
    under: list[tuple[HeldRail, Patches, list[np.ndarray]]]
    middle: float  # m, X between the ends of the walls
    dragged: int  # patterns of traction along X


def _placed(
    held: Sequence[HeldRail],
    faces: Faces,
    reach: tuple[float, float],
    stations: np.ndarray,
    patterns: int,
    dragged: int,
) -> _Placed:
    count = faces.axis.size
    half = half_sizes(faces)
    gram = np.zeros((stations.size, count, patterns, patterns))
    pressed = faces.centre[:, 0] + stations[:, None]
    part = np.stack(
        [part_of_wall(x, long, reach, patterns) for x, long in zip(pressed.T, half[:, 0])], axis=1
    )
    part = (part - np.stack([pressed, np.zeros_like(pressed)], axis=-1)) / half[:, :1]
    part[..., 0] = part[..., 0].clip(-FARTHEST, FARTHEST)
    rail_of = np.full(count, -1)
    under: list[tuple[HeldRail, Patches, list[np.ndarray]]] = []
    rails = 0
    for rail in held:
        patches = Patches(rail.rail, patterns, dragged)
        places = [patches.under(faces, half, signs, reach, stations) for signs in rail.images]
        if patches.found:
            under.append((rail, patches, places))
        grams = np.array([patch.gram for patch in patches.found] + [np.zeros((patterns, patterns))])
        for number in places:
            gram += grams[number]
            here = (number >= 0).any(axis=0)
            rail_of[here] = rails
            rails += bool(here.any())
    middle = 0.5 * (reach[0] + reach[1])
    return _Placed(stations, gram, part, rail_of, half, under, middle, dragged)


def _solved(own: _Placed, modes: int, joints: bool) -> Compliance:
    """As ``of_rails``."""
    stations, count, patterns = own.gram.shape[:3]
    swung = np.zeros((stations, count, patterns + own.dragged, modes))
    frequencies: list[np.ndarray] = []
    parts: list[joint_terms.Part] = []
    warm = np.zeros((stations, count, patterns, FIELDS))
    beside = pairs.beside(own.rail)
    near = np.zeros((stations, *beside.shape, patterns, patterns + own.dragged))
    for solved_before, (rail, patches, places) in enumerate(own.under):
        # An additional last place without response, for faces without a wall (number -1).
        together, number_of = pressed_together(places, len(patches.found), beside)
        with one_of(solved_before, len(own.under)):
            answer, heated, frequency, moved, terms = patches.solved(
                rail, own.middle, modes, together, joints
            )
        between = np.pad(answer, [(0, 1), (0, 0), (0, 0)])
        heated, moved = (np.pad(each, [(0, 1), (0, 0), (0, 0)]) for each in (heated, moved))
        for number, signs in zip(places, rail.images):
            # the fields linear in y and z change sign with the image
            warm += heated[number] * np.r_[1.0, signs, 1.0]
            near += between[number_of(number)]
            swung += moved[number]
            if (number >= 0).any():
                frequencies.append(frequency)
                if terms is not None:
                    parts.append(joint_terms.Part(number, signs, terms))
    return Compliance(
        travel=own.travel,
        near=near,
        gram=own.gram,
        part=own.part,
        rail=own.rail,
        half=own.half,
        frequency=np.array(frequencies).reshape(len(frequencies), modes),
        swung=swung,
        warm=warm,
        joints=joint_terms.together(parts, patterns, own.dragged) if parts else None,
    )
