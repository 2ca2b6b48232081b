"""From a scene and its mesh to the arrays of the loop: operator, surfaces, the rigid part of a free
platform, initial state."""

from typing import NamedTuple

import numpy as np

from tipoff.highfi.contact import surface
from tipoff.highfi.extruded import mesh as pencils
from tipoff.highfi.mesh.rail_mesh import RailMesh
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.state import records
from tipoff.highfi.statics import assembly, thermal
from tipoff.kernels import rotation
from tipoff.kernels.memory import zeros
from tipoff.mechanics import comoving
from tipoff.mechanics import model as scene_model
from tipoff.scenes.body import tensor
from tipoff.scenes.effects.structural_damping import Damping
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.scene import Scene

_MOST_SLABS = 64
_SAME = 1e-9  # m: two places closer than this are the same


class System(NamedTuple):
    """Constant records of one run.

    ``number`` (n,) of each mesh node in the nodal arrays; ``moving_mass`` kg of the nodal arrays,
    zero where clamped; ``origin`` (3,) m: the frame's origin at ignition in scene axes;
    ``body_offset`` (3,) m from it to the platform's mass centre; ``warm`` (n,3) m: displacement by
    temperature of the nodal arrays, None where the scene has none.
    """

    model: scene_model.Model
    mesh: RailMesh
    operator: assembly.Operator
    number: np.ndarray
    rail: records.Rail
    moving_mass: np.ndarray
    surface: records.Surface
    faces: scene_model.Faces
    frame: records.Frame | None
    drive: records.Drive
    origin: np.ndarray
    body_offset: np.ndarray
    warm: np.ndarray | None


def build(scene: Scene, numerics: Numerics, mesh: RailMesh) -> System:
    """Constant records of a run on ``mesh``. Raises SceneError for a platform that cannot hold its
    rails, MeshError for warm rails that nothing holds."""
    model = scene_model.build(scene)
    material = scene.rail.material
    operator = assembly.build(
        mesh, material.density, material.youngs_modulus, material.poisson_ratio
    )
    moving = np.where(operator.free, operator.mass, 0.0)
    frame, origin, offset = None, np.zeros(3), np.zeros(3)
    if model.platform is not None:
        frame, origin = _rigid_part(scene, model.platform, mesh.points, moving)
        offset = np.array(model.platform.mass_centre) - origin
    # The model counts walls from the platform's mass centre, the loop from the frame's origin.
    faces = model.faces._replace(wall=model.faces.wall + offset[model.faces.axis])
    damping = scene.rail.damping.record() if scene.rail.damping else None
    rail, number = _rail(mesh.points - origin, operator, damping)
    masses = np.where(rail.inverse_mass > 0.0, rail.mass, 0.0)
    surfaces = {name: number[facets] for name, facets in mesh.surfaces.items()}
    warm = _warmed(scene, model, mesh, rail, number)
    places = rail.points if warm is None else rail.points + warm
    gauss = surface.build(
        surfaces, places, faces, numerics.points_per_edge(), rail.clamped, model.plate.thickness
    )
    drive = records.Drive(model.thrust_arm, model.reacts_on_platform, float(moving.sum()))
    return System(
        model,
        mesh,
        operator,
        number,
        rail,
        masses,
        gauss,
        faces,
        frame,
        drive,
        origin,
        offset,
        warm,
    )


def _warmed(
    scene: Scene, model: scene_model.Model, mesh: RailMesh, rail: records.Rail, number: np.ndarray
) -> np.ndarray | None:
    if model.thermal is None:
        return None
    found = zeros(rail.points.shape, order="F")
    found[number] = thermal.displacement(mesh, scene.rail.material, model.thermal)
    return found


def _rail(
    points: np.ndarray, operator: assembly.Operator, damping: Damping | None
) -> tuple[records.Rail, np.ndarray]:
    """Nodal arrays in the loop's own numbering, and the number (n,) of each mesh node in it."""
    found = pencils.find(points, operator)
    columns, number = found if found else (None, along_x(points))
    size = -(-(number.max() + 1) // pencils.LANES) * pencils.LANES
    place, mass, inverse = zeros((size, 3), order="F"), zeros((size,)), zeros((size,))
    place[number], mass[number] = points, operator.mass
    inverse[number[operator.free]] = 1.0 / operator.mass[operator.free]
    elements, blocks = None, None
    if columns is None:
        elements, blocks = (
            general_elements(points, operator, number),
            np.append(np.arange(0, size, pencils.CHUNK), size),
        )
    else:
        blocks = columns.chunks * columns.stride
    clamped = np.sort(number[~operator.free])
    held = np.searchsorted(clamped, blocks)
    return records.Rail(
        place, mass, inverse, clamped, held, columns, elements, blocks, damping
    ), number


def along_x(points: np.ndarray) -> np.ndarray:
    """Number (n,) of each node of a mesh of any shape: those near each other along X come together,
    so that they meet in the cache."""
    number = np.empty(len(points), dtype=np.int64)
    x, y, z = np.round(points / _SAME).T
    number[np.lexsort((z, y, x))] = np.arange(len(points))
    return number


def general_elements(
    points: np.ndarray, operator: assembly.Operator, number: np.ndarray
) -> records.Elements:
    """Elements in slabs along X, by the ``number`` (n,) of each node in the nodal arrays and in the
    order of their first one.

    A slab is at least as thick as the longest element, and an element belongs to the one that holds
    the middle of its extent (the mean of its nodes may lie elsewhere): so elements of slabs with
    one between share no node.
    """
    x = points[operator.cells][:, :, 0]
    middle, longest = 0.5 * (x.min(axis=1) + x.max(axis=1)), np.ptp(x, axis=1).max()
    width = max(1.001 * longest, np.ptp(middle) / _MOST_SLABS)
    slab = ((middle - middle.min()) / width).astype(np.int64)
    cells = number[operator.cells]
    order = np.lexsort((cells.min(axis=1), slab))
    slabs = np.searchsorted(slab[order], np.arange(slab.max() + 2))
    return records.Elements(
        cells[order].astype(np.uint32), operator.shape_class[order], operator.stiffness, slabs
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
    return records.Frame(mass, np.linalg.inv(inertia), platform.mass), centre


def _parallel_axis(arm: np.ndarray) -> np.ndarray:
    square = (arm**2).sum(axis=1)
    return square[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]


def initial_state(system: System) -> tuple[records.State, records.Active]:
    """State at ignition, in the frame of ``mechanics.comoving``; velocities are still at t = 0."""
    model, first, start = system.model, system.model.initial, comoving.start(system.model)
    payload = records.Body(
        start.place, start.velocity, np.array(rotation.exponential(first.attitude)), np.zeros(3)
    )
    turn = rotation.matrices(payload.quaternion[None])[0]
    payload.spin[:] = turn @ (model.payload.inertia @ np.array(first.rate))
    platform = records.Body(
        np.subtract(system.origin, comoving.frame(model).origin),
        np.zeros(3),
        np.array([1.0, 0.0, 0.0, 0.0]),
        np.zeros(3),
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
    count = system.faces.axis.size
    parts, groups = system.rail.blocks.size - 1, system.surface.groups.first_face.size - 1
    state = records.State(
        payload,
        platform,
        zeros(nodes, order="F"),
        velocity,
        zeros(nodes, order="F"),
        np.zeros(nodes),
        np.zeros((parts, 3)),
        np.zeros((parts, 6)),
        np.zeros(6),
        np.zeros(records.MOTION_SIZE),
        system.moving_mass @ velocity,
        system.moving_mass @ system.rail.points,
        np.zeros(records.LOAD_SIZE),
        np.zeros((groups, records.LOAD_SIZE)),
        np.zeros(records.WORK_SIZE),
        np.zeros(6),
        np.zeros((count, 3)),
        _history(system.rail, nodes, parts),
    )
    room, size = surface.capacity(system.surface), nodes[0]
    active = records.Active(
        np.zeros((groups, 2), dtype=np.int64),
        np.zeros((room, 2), dtype=np.int64),
        np.zeros(room, dtype=np.int64),
        np.zeros(room),
        np.zeros(np.unique(system.surface.facets).size, dtype=np.int64),
        np.zeros(size, dtype=np.bool_),
        np.zeros(nodes),
        np.zeros(size),
        np.zeros(count, dtype=np.int64),
        np.full(count, records.UNKNOWN),
        np.zeros((count, 3)),
    )
    return state, active


def _history(rail: records.Rail, nodes: tuple[int, ...], parts: int) -> records.History | None:
    if rail.damping is None:
        return None
    return records.History(
        elastic=zeros(nodes, order="F"),
        displacement=zeros(nodes, order="F"),
        force=zeros(nodes, order="F"),
        drag=np.zeros((parts, 6)),
        loss=np.zeros(parts),
    )
