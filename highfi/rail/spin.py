"""The largest rotation rate of a platform for which its rails are linear in its frame.

Rails are linear elastic in the frame of the platform. Centrifugal load on the deformed rail is taken
into account. The stiffening by the tension that it causes is not. For a beam that turns at W with a
lowest frequency w at rest

    w(W)^2 = w^2 + k W^2,   k = 1.193 for a cantilever clamped on the axis, across the plane of turning

(Southwell and Gough 1921; Leissa, Applied Mechanics Reviews 34 (1981) 629), so what is left out is of
the relative size (W / w)^2 of the stiffness, and larger where the clamp is far from the axis. A scene
is refused where this ratio exceeds ``MOST``.
"""

import numpy as np

from tipoff.highfi.mesh import pieces
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.rail.scene_mesh import geometry, make_mesh
from tipoff.highfi.rail.step_cost import spacing
from tipoff.highfi.statics import assembly, vibration
from tipoff.highfi.statics.solve import Clamped
from tipoff.mechanics import model as scene_model
from tipoff.scenes.effects import thrust
from tipoff.scenes.effects.mount_stiffness import MountStiffness
from tipoff.scenes.faults import Fault, SceneError
from tipoff.scenes.rail import MaterialTable, MeshTable, SectionTable
from tipoff.scenes.scene import Scene

MOST = 0.01  # (W / w)^2
_CANTILEVER = 3.516 / np.sqrt(12.0)  # of w = _CANTILEVER sqrt(E / rho) thickness / length^2
_COARSE = 4e-3  # m, elements of a built-in rail whose lowest frequency is found
_FEW = 20_000  # nodes of a mesh that is taken as it is
_FREQUENCIES: dict[tuple, float] = {}  # rad/s, by geometry and material


def expected_rate(scene: Scene) -> float:
    """Largest rate (rad/s) of the platform that its initial rate and the reaction to the thrust can
    give it; contact is not in it."""
    model = scene_model.build(scene)
    if model.platform is None:
        return 0.0
    rate = float(np.linalg.norm(model.initial.platform_rate))
    if not model.reacts_on_platform:
        return rate
    offset = model.thrust_offset
    place = np.array([-model.thrust_arm, 0.0, 0.0]) if offset is None else np.array(offset.arm)
    direction = np.array([1.0, 0.0, 0.0]) if offset is None else np.array(offset.direction)
    impulse = thrust.impulse(model.thrust, scene.time_limit)
    moment = np.cross(place + model.payload.mass_centre - model.platform.mass_centre, direction)
    kick = model.platform.inverse_inertia @ (moment * float(impulse))
    return rate + float(np.linalg.norm(kick))


def rate_never_checked(scene: Scene, mesh: RailMesh) -> float:
    """Rate (rad/s) of the platform that is within the limit for any rail of this length. It belongs
    to a strip as thin as one element and held at one end: no rail on rigid mounts is softer. Zero
    on joints, whose stiffness has no lower bound."""
    if scene.rail.joint() is not None:
        return 0.0
    material = scene.rail.material
    is_section = isinstance(scene.rail, SectionTable)
    thickness = scene.rail.thickness if is_section else spacing(mesh)
    length = np.ptp(mesh.points, axis=0).max()
    speed = np.sqrt(material.youngs_modulus / material.density)
    return float(np.sqrt(MOST) * _CANTILEVER * speed * thickness / length**2)


def lowest_frequency(scene: Scene, mesh: RailMesh) -> float:
    """Lowest frequency (rad/s) of the rails held at their mounts, on ``mesh``; where that is
    large, of a built-in section in elements of at least 4 mm, and of a mesh file in its own."""
    if len(mesh.points) <= _FEW:
        return lowest_of(mesh, scene.rail.material, scene.rail.joint())
    key = (geometry(scene), scene.rail.model_dump_json())
    if key not in _FREQUENCIES:
        if isinstance(scene.rail, SectionTable):
            mesh = make_mesh(scene, max(_COARSE, scene.rail.thickness))
        elif isinstance(scene.rail, MeshTable):
            mesh = read(scene.rail.path())
        _FREQUENCIES[key] = lowest_of(mesh, scene.rail.material, scene.rail.joint())
    return _FREQUENCIES[key]


def lowest_of(
    mesh: RailMesh, material: MaterialTable, joint: MountStiffness | None = None
) -> float:
    """Lowest frequency (rad/s) of all solids of ``mesh`` that mounts hold, rigid ones or on a
    ``joint``; infinite without one."""
    found = [np.inf]
    for solid, _ in pieces.distinct(mesh):
        if not solid.surfaces["mount"].size:
            continue
        operator = assembly.of_material(solid, material, joint=joint)
        if not operator.free.any():
            continue
        clamped = Clamped(operator)
        mass = np.repeat(operator.mass, 3)[clamped.free]
        found.append(vibration.modes(clamped.stiffness, mass, clamped.solve, 1)[0][0])
    return float(min(found))


def check(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError where the platform of ``scene`` turns so fast that its rails on ``mesh`` are
    not linear."""
    if scene.platform is None or (rate := expected_rate(scene)) <= rate_never_checked(scene, mesh):
        return
    if words := too_fast(rate, lowest_frequency(scene, mesh)):
        raise SceneError([Fault(scene.name, "initial.platform_rate, thrust", *words)])


def too_fast(rate: float, frequency: float) -> tuple[str, str] | None:
    """What is given and what is expected where a platform with rails of this lowest ``frequency``
    (rad/s) turns at ``rate`` (rad/s) beyond the limit."""
    share = (rate / frequency) ** 2
    if share <= MOST:
        return None
    return (
        f"a platform that turns at {rate:.4g} rad/s",
        f"at most {np.sqrt(MOST) * frequency:.4g} rad/s: the lowest frequency of the rails is "
        f"{frequency:.4g} rad/s, and linear rails leave out a share of {share:.2g} of their "
        f"stiffness, allowed {MOST:g}",
    )
