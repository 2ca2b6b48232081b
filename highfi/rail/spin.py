"""The largest rotation rate of a platform for which its rails are linear in its frame.

Rails are linear elastic in the frame of the platform. Centrifugal load on the deformed rail is
included. The stiffening by the tension that it causes is left out. For a beam that turns at W with
a lowest frequency w at rest

    w(W)^2 = w^2 + k W^2,   k = 1.193 for a cantilever clamped on the axis, across the plane of turning

(Southwell and Gough 1921; Leissa, Applied Mechanics Reviews 34 (1981) 629). So the relative error
of the stiffness is about (W / w)^2, and larger if the clamp is far from the axis. A scene is
refused if this ratio exceeds ``MOST``.
"""

from functools import lru_cache

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.highfi.mesh.rail_mesh import RailMesh, read
from tipoff.highfi.rail.geometry import geometry
from tipoff.highfi.rail.scene_mesh import make_mesh
from tipoff.highfi.rail.step_cost import spacing
from tipoff.highfi.statics import held
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust
from tipoff.mechanics.laws.mount_stiffness import MountStiffness
from tipoff.scenes import launch, scene_model
from tipoff.scenes.rail import MeshTable, SectionTable
from tipoff.scenes.rail_base import MaterialTable
from tipoff.scenes.rounding import apart
from tipoff.scenes.scene import Scene

MOST = 0.01  # (W / w)^2
_CANTILEVER = 3.516 / np.sqrt(12.0)  # in w = _CANTILEVER sqrt(E / rho) thickness / length^2
_COARSE = 4e-3  # m, smallest elements of a built-in rail to find its lowest frequency
_FEW = 20_000  # nodes; a larger mesh is not used to find the lowest frequency
_FREQUENCIES: dict[tuple, float] = {}  # rad/s, by geometry and material


def expected_rate(scene: Scene) -> float:
    """Upper bound (rad/s) of the rate of the platform from its initial rate and the reaction to the
    thrust; contact is not included."""
    model = scene_model.build(scene)
    if model.platform is None:
        return 0.0
    rate = float(np.linalg.norm(model.initial.platform_rate))
    if not model.reacts_on_platform:
        return rate
    centre = np.subtract(model.payload.mass_centre, model.platform.mass_centre)
    if model.pushers is not None:
        pushes = model.pushers
        turning = np.cross(pushes.point + centre, pushes.direction)
        kick = model.platform.inverse_inertia @ (
            ends.spring_impulses(launch.of_scene(scene)) @ turning
        )
        return rate + float(np.linalg.norm(kick))
    offset = model.thrust_offset
    place = np.array([-model.thrust_arm, 0.0, 0.0]) if offset is None else np.array(offset.arm)
    direction = np.array([1.0, 0.0, 0.0]) if offset is None else np.array(offset.direction)
    impulse = thrust.impulse(model.thrust, scene.time_limit)
    moment = np.cross(place + model.payload.mass_centre - model.platform.mass_centre, direction)
    kick = model.platform.inverse_inertia @ (moment * float(impulse))
    return rate + float(np.linalg.norm(kick))


def rate_never_checked(scene: Scene, mesh: RailMesh) -> float:
    """Rate (rad/s) of the platform that is within the limit for any rail of this length on rigid
    mounts. It is the limit of the softest rail: a strip one element thick, held at one end. Zero on
    joints, whose stiffness has no lower bound."""
    if scene.rail.joint() is not None:
        return 0.0
    material = scene.rail.material
    is_section = isinstance(scene.rail, SectionTable)
    thickness = scene.rail.thickness if is_section else spacing(mesh)
    length = np.ptp(mesh.points, axis=0).max()
    speed = np.sqrt(material.youngs_modulus / material.density)
    return float(np.sqrt(MOST) * _CANTILEVER * speed * thickness / length**2)


def lowest_frequency(scene: Scene, mesh: RailMesh) -> float:
    """Lowest frequency (rad/s) of the rails held at their mounts, on ``mesh``. If the mesh is
    large, it comes from a built-in section in elements of at least 4 mm, or from the elements of
    the mesh file."""
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


@lru_cache(maxsize=4)  # runs on one rail share it
def lowest_of(
    mesh: RailMesh, material: MaterialTable, joint: MountStiffness | None = None
) -> float:
    """Lowest frequency (rad/s) of all mounted solids of ``mesh``, on rigid mounts or on a
    ``joint``; infinite without one."""
    found = [np.inf]
    for solid in held.distinct(mesh, material, joint):
        if solid.rail.surfaces["mount"].size and solid.operator.free.any():
            found.append(solid.modes(1)[0][0])
    return float(min(found))


def check(scene: Scene, mesh: RailMesh) -> None:
    """Raise SceneError if the platform of ``scene`` turns too fast for linear rails on ``mesh``."""
    if scene.platform is None or (rate := expected_rate(scene)) <= rate_never_checked(scene, mesh):
        return
    if words := too_fast(rate, lowest_frequency(scene, mesh)):
        raise SceneError([Fault(scene.name, "initial.platform_rate, thrust", *words)])


def too_fast(rate: float, frequency: float) -> tuple[str, str] | None:
    """Given and expected values if a platform with rails of this lowest ``frequency`` (rad/s) turns
    at a ``rate`` (rad/s) beyond the limit."""
    share = (rate / frequency) ** 2
    if share <= MOST:
        return None
    given, most = apart(rate, float(np.sqrt(MOST) * frequency), 4)
    return (
        f"a platform that turns at {given} rad/s",
        f"at most {most} rad/s: the lowest frequency of the rails is "
        f"{frequency:.4g} rad/s, and linear rails leave out a share of {share:.2g} of their "
        f"stiffness, allowed {MOST:g}",
    )
