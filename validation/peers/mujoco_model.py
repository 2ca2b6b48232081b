"""The model ``springs`` in MuJoCo: two free bodies; a small ball at each pad face touches one box, its
wall.

MuJoCo's contact is a constraint on accelerations. With the impedance d, the reference acceleration
-b v / d - k p / d and an inverse mass D along the contact it gives the force

    N = (k p + b v - d a) / ((1 - d) D + d A)

where A f is the acceleration by the contacts and a the acceleration by all other forces. At the smallest
impedance, 1e-4, both terms with d are below a thousandth of N. So k = K (1 - d) D and b = C (1 - d) D
make a spring K and a damper C that never pull. Friction has an elliptic cone. A slip s increases the
normal force by mu B s, with the damping B of the friction constraint. So B is small, and ``impratio`` is
large, because friction must still hold below 10 mm/s.

Source: MuJoCo documentation, Computation, sections "Constraint model" and "Parameters".
"""

import time as clock
from typing import Any, NamedTuple

import numpy as np

from validation.peers.case import PeerMissing, require_finished
from validation.peers.springs_problem import Problem

IMPEDANCE = 1e-4
RADIUS = 1e-3  # m of the balls
_THICK = 4e-3  # m of the walls
_REACH = 12e-3  # m, half the width of the walls
_FRICTION_DAMPING = 0.4  # N s/m
_IMPRATIO = 1e3


class Samples(NamedTuple):
    """Samples of the payload's motion after every step, and processor time (s)."""

    time: np.ndarray  # (n,) s
    rate: np.ndarray  # (n,3) rad/s, body axes
    velocity: np.ndarray  # (3,) m/s at the end
    cpu_s: float


def engine() -> Any:
    """The module ``mujoco``. Raises PeerMissing."""
    try:
        import mujoco
    except ImportError as error:
        raise PeerMissing(f"mujoco does not load ({error}); pip install 'tipoff[peers]'") from error
    return mujoco


def version() -> str:
    """Version of MuJoCo. Raises PeerMissing."""
    return engine().__version__


def run(problem: Problem, law: dict, friction: float, step: float, until: float) -> Samples:
    """Motion to the time ``until`` (s) by Runge-Kutta of order four with steps of ``step`` (s), on
    the linear ``law`` and a coefficient of ``friction``."""
    mujoco = engine()
    model = mujoco.MjModel.from_xml_string(_xml(problem, law, friction, step, 1.0))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    payload, platform = (model.body(name).id for name in ("payload", "platform"))
    inverse = model.body_invweight0[payload, 0] + model.body_invweight0[platform, 0]
    model = mujoco.MjModel.from_xml_string(_xml(problem, law, friction, step, inverse))
    data = mujoco.MjData(model)
    direction, arm = np.array(problem.direction), np.array(problem.arm)

    def push(model, data) -> None:
        turn = data.xmat[payload].reshape(3, 3)
        force = turn @ (problem.thrust(data.time) * direction)
        moment = np.cross(turn @ arm, force)
        apart = data.xipos[payload] - data.xipos[platform]
        data.xfrc_applied[payload] = [*force, *moment]
        data.xfrc_applied[platform] = [*-force, *(-moment - np.cross(apart, force))]

    count = int(np.ceil(until / step - 1e-9))
    rate, began = np.zeros((count + 1, 3)), clock.thread_time()
    mujoco.set_mjcb_control(push)
    try:
        for number in range(count):
            mujoco.mj_step(model, data)
            rate[number + 1] = data.qvel[3:6]
    finally:
        mujoco.set_mjcb_control(None)
    spent = clock.thread_time() - began
    # MuJoCo starts again from time 0 after a bad step
    require_finished("MuJoCo", float(data.time), step * count, rate, data.qvel)
    return Samples(step * np.arange(count + 1), rate, data.qvel[:3].copy(), spent)


def _xml(problem: Problem, law: dict, friction: float, step: float, inverse: float) -> str:
    """The model as MuJoCo reads it; ``inverse`` (1/kg) is D."""
    scale = (1.0 - IMPEDANCE) * inverse
    spring = f"{-law['stiffness'] * scale:.17g} {-law['damping'] * scale:.17g}"
    slip = f"-1e-6 {-_FRICTION_DAMPING * scale:.17g}"
    balls, walls, pairs = [], [], []
    middle = 0.5 * (problem.ends[0] + problem.ends[1])
    for i, (point, normal, wall) in enumerate(zip(problem.points, problem.normals, problem.walls)):
        place = point - RADIUS * normal
        balls.append(f'<geom name="ball{i}" size="{RADIUS}" pos="{_text(place)}" {_GHOST}/>')
        size = np.where(normal == 0.0, _REACH, 0.5 * _THICK)
        size[0] = 0.5 * (problem.ends[1] - problem.ends[0])
        across = point + np.subtract(problem.place, problem.platform_place)
        centre = np.where(normal == 0.0, across, (wall + 0.5 * _THICK) * normal)
        centre[0] = middle
        walls.append(
            f'<geom name="wall{i}" type="box" size="{_text(size)}" pos="{_text(centre)}" {_GHOST}/>'
        )
        pairs.append(
            f'<pair geom1="ball{i}" geom2="wall{i}" condim="{3 if friction else 1}" '
            f'solref="{spring}" solreffriction="{slip}" '
            f'solimp="{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2" friction="{friction} {friction}"/>'
        )
    return (
        f'<mujoco><option timestep="{step:.17g}" gravity="0 0 0" integrator="RK4" cone="elliptic" '
        f'impratio="{_IMPRATIO}" tolerance="1e-14" iterations="200"/><worldbody>'
        + _body("payload", problem.place, problem.mass, problem.inertia, balls)
        + _body(
            "platform",
            problem.platform_place,
            problem.platform_mass,
            problem.platform_inertia,
            walls,
        )
        + f"</worldbody><contact>{''.join(pairs)}</contact></mujoco>"
    )


_GHOST = 'contype="0" conaffinity="0" mass="0"'


def _body(name: str, place, mass: float, inertia: np.ndarray, geoms: list[str]) -> str:
    tensor = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return (
        f'<body name="{name}" pos="{_text(place)}"><freejoint/>'
        f'<inertial pos="0 0 0" mass="{mass:.17g}" fullinertia="{_text(tensor)}"/>'
        f"{''.join(geoms)}</body>"
    )


def _text(values) -> str:
    return " ".join(f"{value:.17g}" for value in values)
