"""Constants and initial state of a run, from a scene and its mesh."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.highfi.contact import surface
from tipoff.highfi.dynamics import mounts, observe, pushers
from tipoff.highfi.extruded import mesh as extruded
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.state import records
from tipoff.highfi.statics import assembly, thermal
from tipoff.kernels import rotation
from tipoff.kernels.memory import zeros
from tipoff.mechanics import books, comoving
from tipoff.mechanics.absent import NO_DAMPING, NO_PUSHERS
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.structural_damping import Damping
from tipoff.mechanics.model import Faces, Model
from tipoff.scenes import scene_model
from tipoff.scenes.body import inverse, tensor
from tipoff.scenes.rail_base import MaterialTable
from tipoff.scenes.scene import Scene

_MOST_SLABS = 64
_SAME = 1e-9  # m: two places closer than this are the same
_FEWEST = (2, 3)  # shape of a nodal array of no use; Numba takes columns of fewer nodes for rows


class System(NamedTuple):
    """Constant records of a run; they do not depend on its step."""

    model: Model
    mesh: RailMesh
    operator: assembly.Operator
    number: np.ndarray  # (n,) place of each mesh node in the nodal arrays
    rail: records.Rail
    moving_mass: np.ndarray  # (n,) kg, of the nodal arrays, zero if clamped or at rest
    nodes: slice  # part of the nodal arrays that contains all stepped nodes
    surface: records.Surface
    faces: Faces
    frame: records.Frame | None  # None: fixed platform
    drive: records.Drive
    pushers: Pushers  # in frame axes from the frame's origin; none without
    hold_down: HoldDown | None  # in frame axes from the frame's origin
    origin: np.ndarray  # (3,) m, the frame's origin at ignition in scene axes
    body_offset: np.ndarray  # (3,) m, from the frame's origin to the platform's mass centre
    warm: np.ndarray | None  # (n,3) m, thermal displacement of the nodal arrays, or None


def build(scene: Scene, numerics: Numerics, mesh: RailMesh) -> System:
    """Constant records of a run on ``mesh``. Raises SceneError if the platform is too light for its
    rails, MeshError for warm rails without mounts."""
    model = scene_model.build(scene)
    material = scene.rail.material
    assembled = _assembled(mesh, material, scene.rail.joint())
    operator, number = assembled.operator, assembled.number
    moving = np.where(operator.free, operator.mass, 0.0)
    frame, origin, offset = None, np.zeros(3), np.zeros(3)
    if model.platform is not None:
        frame, origin = _rigid_part(scene, model.platform, mesh.points, moving)
        offset = np.array(model.platform.mass_centre) - origin
    # In the model, walls are relative to the platform's mass centre; in the loop, to the frame's
    # origin.
    faces = model.faces._replace(wall=model.faces.wall + offset[model.faces.axis])
    damping = scene.rail.damping.record() if scene.rail.damping else NO_DAMPING
    rail = _rail(mesh.points - origin, assembled, damping)
    masses = np.where(rail.inverse_mass > 0.0, rail.mass, 0.0)
    surfaces = {name: number[facets] for name, facets in mesh.surfaces.items()}
    warm = _warmed(scene, model, mesh, rail, number)
    places = rail.points if warm is None else rail.points + warm
    walls = surface.build(
        surfaces, places, faces, numerics.cells, rail.clamped, model.plate.thickness
    )
    drive = records.Drive(
        arm=model.thrust_arm,
        reacts_on_platform=model.reacts_on_platform,
        moving_mass=float(moving.sum()),
    )
    return System(
        model=model,
        mesh=mesh,
        operator=operator,
        number=number,
        rail=rail,
        moving_mass=masses,
        nodes=slice(0, masses.size),
        surface=with_moving_walls(walls, masses),
        faces=faces,
        frame=frame,
        drive=drive,
        pushers=_from_origin(model.pushers or NO_PUSHERS, offset),
        hold_down=_latch_from_origin(model.hold_down, offset),
        origin=origin,
        body_offset=offset,
        warm=warm,
    )


def _from_origin(found: Pushers, offset: np.ndarray) -> Pushers:
    """Pushers with places from the frame's origin, ``offset`` (3,) m from which the platform's mass
    centre is."""
    return found._replace(origin=found.origin + found.direction @ offset)


def _latch_from_origin(found: HoldDown | None, offset: np.ndarray) -> HoldDown | None:
    """The same for a hold-down."""
    if found is None:
        return None
    y, z = (np.array(found.line) + offset[1:]).tolist()
    return found._replace(line=(y, z))


def with_moving_walls(surfaces: records.Surface, moving_mass: np.ndarray) -> records.Surface:
    """``surfaces``, of whose wall nodes those move that have a ``moving_mass`` (n,) kg."""
    found = np.unique(surfaces.facets)
    return surfaces._replace(walls=found[moving_mass[found] > 0.0])


def _warmed(
    scene: Scene, model: Model, mesh: RailMesh, rail: records.Rail, number: np.ndarray
) -> np.ndarray | None:
    if model.thermal is None:
        return None
    found = zeros(rail.points.shape, order="F")
    found[number] = thermal.displacement(
        mesh, scene.rail.material, model.thermal, scene.rail.joint()
    )
    return found


class _Assembled(NamedTuple):
    """The operator of a mesh, its columns if it is extruded, and the number (n,) of each mesh node in
    the nodal arrays."""

    operator: assembly.Operator
    columns: extruded.Columns | None
    number: np.ndarray


@lru_cache(maxsize=4)  # the meshes of one condition and its refinements
def _assembled(mesh: RailMesh, material: MaterialTable, joint: MountStiffness | None) -> _Assembled:
    """What the runs on one rail share."""
    operator = assembly.of_material(mesh, material, joint=joint)
    found = extruded.find(mesh.points, operator)
    columns, number = found if found else (None, along_x(mesh.points))
    return _Assembled(operator, columns, number)


def _rail(points: np.ndarray, assembled: _Assembled, damping: Damping) -> records.Rail:
    """Nodal arrays in the numbering of the loop; ``points`` (n,3) m from the frame's origin."""
    operator, columns, number = assembled
    size = -(-(number.max() + 1) // extruded.LANES) * extruded.LANES
    place, mass, inverse = zeros((size, 3), order="F"), zeros((size,)), zeros((size,))
    place[number], mass[number] = points, operator.mass
    inverse[number[operator.free]] = 1.0 / operator.mass[operator.free]
    elements, blocks = None, None
    if columns is None:
        elements, blocks = (
            general_elements(points, operator, number),
            np.append(np.arange(0, size, extruded.CHUNK), size),
        )
    else:
        blocks = columns.chunks * columns.stride
    clamped = np.sort(number[~operator.free])
    return records.Rail(
        points=place,
        mass=mass,
        inverse_mass=inverse,
        clamped=clamped,
        first_clamped=np.searchsorted(clamped, blocks),
        columns=columns,
        elements=elements,
        blocks=blocks,
        damping=damping,
        mounts=mounts.build(operator.joints, number, blocks),
    )


def along_x(points: np.ndarray) -> np.ndarray:
    """Number (n,) of each node of a mesh of any shape: neighbours along X are adjacent, so that
    they share cache lines."""
    number = np.empty(len(points), dtype=np.int64)
    x, y, z = np.round(points / _SAME).T
    number[np.lexsort((z, y, x))] = np.arange(len(points))
    return number


def general_elements(
    points: np.ndarray, operator: assembly.Operator, number: np.ndarray
) -> records.Elements:
    """Elements in slabs along X, sorted by their first node; ``number`` (n,) of each node in the
    nodal arrays.

    A slab is at least as thick as the longest element. An element belongs to the slab that contains
    the middle of its extent (not the mean of its nodes, which may lie elsewhere). So elements of
    slabs with one slab between them share no node.
    """
    x = points[operator.cells][:, :, 0]
    middle, longest = 0.5 * (x.min(axis=1) + x.max(axis=1)), np.ptp(x, axis=1).max()
    width = max(1.001 * longest, np.ptp(middle) / _MOST_SLABS)
    slab = ((middle - middle.min()) / width).astype(np.int64)
    cells = number[operator.cells]
    order = np.lexsort((cells.min(axis=1), slab))
    slabs = np.searchsorted(slab[order], np.arange(slab.max() + 2))
    return records.Elements(
        cells=cells[order].astype(np.uint32),
        shape_class=operator.shape_class[order],
        stiffness=operator.stiffness,
        slabs=slabs,
    )


def _rigid_part(scene, platform, points, moving) -> tuple[records.Frame, np.ndarray]:
    """Platform without its moving rail nodes: mass, inverse inertia, mass centre (parallel
    axes)."""
    mass = platform.mass - moving.sum()
    centre = (platform.mass * np.array(platform.mass_centre) - moving @ points) / mass
    arm = points - np.array(platform.mass_centre)
    nodes = np.einsum("n,nij->ij", moving, _parallel_axis(arm))
    shift = mass * _parallel_axis((centre - np.array(platform.mass_centre))[None])[0]
    inertia = tensor(scene.platform.inertia) - nodes - shift
    if mass <= 0.0 or np.linalg.eigvalsh(inertia)[0] <= 0.0:
        raise SceneError(
            [
                Fault(
                    scene.name,
                    "platform.mass, platform.inertia",
                    f"{platform.mass:g} kg",
                    f"a platform that can hold its rails, whose moving part weighs "
                    f"{moving.sum():.4g} kg",
                )
            ]
        )
    frame = records.Frame(
        mass=mass,
        inverse_inertia=inverse(inertia),
        total_mass=platform.mass,
        centre=np.zeros(3),
    )
    return frame, centre


def _parallel_axis(arm: np.ndarray) -> np.ndarray:
    square = (arm**2).sum(axis=1)
    return square[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]


def initial_state(system: System) -> tuple[records.State, records.Active]:
    """State at ignition, in the frame of ``mechanics.comoving``; velocities are still at t = 0."""
    model, first, start = system.model, system.model.initial, comoving.start(system.model)
    payload = records.Body(
        position=start.place,
        velocity=start.velocity,
        quaternion=np.array(rotation.exponential(first.attitude)),
        spin=np.zeros(3),
    )
    turn = rotation.matrices(payload.quaternion[None])[0]
    payload.spin[:] = turn @ (model.payload.inertia @ np.array(first.rate))
    platform = records.Body(
        position=np.subtract(system.origin, comoving.frame(model).origin),
        velocity=np.zeros(3),
        quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
        spin=np.zeros(3),
    )
    nodes = system.rail.points.shape
    velocity = zeros(nodes, order="F")
    if system.frame is not None:
        rate = np.array(first.platform_rate)
        platform.velocity[:] = start.platform_velocity - np.cross(rate, system.body_offset)
        platform.spin[:] = np.linalg.inv(system.frame.inverse_inertia) @ rate
        velocity[system.number] = platform.velocity + np.cross(
            rate, system.rail.points[system.number]
        )
    blocks, groups = system.rail.blocks.size - 1, system.surface.groups.first_face.size - 1
    state = records.State(
        payload=payload,
        platform=platform,
        stepped=records.Stepped(block=np.arange(blocks), in_use=np.array([blocks])),
        displacement=zeros(nodes, order="F"),
        velocity=velocity,
        resistance=zeros(nodes, order="F"),
        contact=np.zeros(nodes),
        turning=np.zeros((blocks, 3)),
        clamping=np.zeros((blocks, 6)),
        mounting=np.zeros((blocks, 6)),
        reaction=np.zeros(6),
        motion=records.Motion(
            velocity=np.zeros(3), turn=np.zeros(9), rate=np.zeros(3), acceleration=np.zeros(3)
        ),
        rail_momentum=system.moving_mass @ velocity,
        rail_moment=system.moving_mass @ system.rail.points,
        load=np.zeros(1, records.LOAD),
        loads=np.zeros(groups, records.LOAD),
        work=np.zeros(2, records.WORK),
        impulse=np.zeros(6),
        face_force=np.zeros((system.faces.axis.size, 3)),
        face_moment=np.zeros((system.faces.axis.size, 3)),
        guide_loads=books.no_loads(int(system.faces.guide.max(initial=-1)) + 1),
        history=_history(system.rail, nodes, blocks),
        pushing=pushers.new_state(system.pushers),
        holding=np.zeros(1),
        sums=np.zeros(observe.SUMS_SIZE),
        evaluated=np.zeros(len(records.COUNTED), dtype=np.int64),
    )
    return state, _active(system, groups)


def _active(system: System, groups: int) -> records.Active:
    """No contact yet."""
    nodes, faces = len(system.rail.points), system.faces.axis.size
    return records.Active(
        node_count=np.zeros(groups, dtype=np.int64),
        node=np.zeros(np.unique(system.surface.facets).size, dtype=np.int64),
        seen=np.zeros(nodes, dtype=np.bool_),
        drag=np.zeros((nodes, 3)),
        node_damping=np.zeros(nodes),
        wait=np.zeros(faces, dtype=np.int64),
        side=np.full(faces, records.UNKNOWN),
        rests=np.zeros(groups, dtype=np.bool_),
        near=np.zeros(groups, dtype=np.bool_),
        struck=np.zeros(faces, records.STRUCK),
    )


def _history(rail: records.Rail, nodes: tuple[int, ...], blocks: int) -> records.History:
    if not any(rail.damping):
        nodes, blocks = _FEWEST, 0
    return records.History(
        elastic=zeros(nodes, order="F"),
        displacement=zeros(nodes, order="F"),
        force=zeros(nodes, order="F"),
        drag=np.zeros((blocks, 6)),
        loss=np.zeros(blocks),
        mounting=np.zeros((blocks, 6)),
    )
