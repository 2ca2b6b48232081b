"""The state at exit for codes of flight: position, velocity, attitude and rates of one run or of
many.

The state is that in the middle of the window at exit (``mechanics.outcome``), 0.1 ms after the
exit: velocity v and rate w are means over the window, and position and attitude at the exit are
advanced to its middle. The error is a t^2 / 2 with the acceleration a and t = 0.1 ms: 5 um at
1,000 m/s2.

``initial_solution`` is in the axes of RocketPy, class ``Flight`` (version 1.12): inertial x East, y
North, z up above sea level; body z to the nose, and x and y along our body axes y and z, or as
``[hand_over]`` places the buttons; Euler parameters from body axes to inertial ones, scalar first;
body rates. The place is that of the mass
centre without propellant.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tipoff.faults import Fault, SceneError
from tipoff.files import write_csv, write_json, write_text
from tipoff.mechanics.run_limits import EXIT_WINDOW
from tipoff.scenes.effects.hand_over import Standing, standing

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

FORMATS = ("rocketpy", "csv")
COMPONENTS = {
    "t": "s",
    **dict.fromkeys(("x", "y", "z"), "m"),
    **dict.fromkeys(("vx", "vy", "vz"), "m/s"),
    **dict.fromkeys(("e0", "e1", "e2", "e3"), "1"),
    **dict.fromkeys(("w1", "w2", "w3"), "rad/s"),
}
# The rotation vector in body axes from the mean attitude has three components, not four.
MINIMAL = {key: unit for key, unit in COMPONENTS.items() if key[0] in "txyzv"} | {
    **dict.fromkeys(("a1", "a2", "a3"), "rad"),
    **dict.fromkeys(("w1", "w2", "w3"), "rad/s"),
}
_AXES = (
    "x East, y North, z up above sea level; body z to the nose; e0..e3 scalar first, body to "
    "inertial axes; body rates"
)


class State(NamedTuple):
    """State at exit of one run, or of n runs with a further first dimension; inertial, in scene
    axes."""

    time: Any  # s since ignition
    position: np.ndarray  # (3,) m, of the mass centre
    velocity: np.ndarray  # (3,) m/s
    quaternion: np.ndarray  # (4,) scalar first, from body axes to scene axes
    rate: np.ndarray  # (3,) rad/s, in body axes


def at_exit(found: Any) -> State:
    """State at exit from an outcome, or from columns of outcomes.

    Raises SceneError for a run that did not leave the rail and settle.
    """
    from scipy.spatial.transform import Rotation  # slow to load

    if found.exit_position is None or found.exit_rate is None:
        raise SceneError([Fault("export", "state at exit", "none", "a run that left the rail")])
    ahead = 0.5 * EXIT_WINDOW
    velocity, rate = np.asarray(found.exit_velocity), np.asarray(found.exit_rate)
    turned = Rotation.from_rotvec(found.exit_attitude) * Rotation.from_rotvec(ahead * rate)
    return State(
        time=np.asarray(found.exit_time) + ahead,
        position=np.asarray(found.exit_position) + ahead * velocity,
        velocity=velocity,
        quaternion=_scalar_first(turned),
        rate=rate,
    )


def _scalar_first(turned: "Rotation") -> np.ndarray:
    """Quaternions (..., 4), scalar first and not negative."""
    return turned.as_quat(canonical=True, scalar_first=True)


def initial_solution(state: State, rail: Standing) -> np.ndarray:
    """(..., 14) ``initial_solution`` of RocketPy, see the module docstring."""
    from scipy.spatial.transform import Rotation  # slow to load

    body = Rotation.from_quat(state.quaternion, scalar_first=True)
    arm = np.array([rail.dry_mass_centre, 0.0, 0.0])
    position = state.position + body.apply(arm)
    velocity = state.velocity + body.apply(np.cross(state.rate, arm))
    turned = Rotation.from_matrix(rail.axes) * body * Rotation.from_matrix(rail.body)
    time = np.asarray(state.time)[..., None]
    place = position @ rail.axes.T + [0.0, 0.0, rail.elevation]
    parts = (time, place, velocity @ rail.axes.T, _scalar_first(turned), state.rate @ rail.body)
    return np.concatenate(parts, axis=-1)


def mean_and_covariance(solutions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (14,) and covariance (13,13) of ``solutions`` (n,14). The covariance is that of the
    ``MINIMAL`` components: the attitude counts by its rotation vector, in body axes, from the mean
    attitude (Markley et al., J. Guid. Control Dyn. 30 (2007) 1193)."""
    from scipy.spatial.transform import Rotation  # slow to load

    turned = Rotation.from_quat(solutions[:, 7:11], scalar_first=True)
    middle = turned.mean()
    mean = solutions.mean(axis=0)
    mean[7:11] = _scalar_first(middle)
    away = (middle.inv() * turned).as_rotvec()
    minimal = np.concatenate([solutions[:, :7], away, solutions[:, 11:]], axis=1)
    return mean, np.cov(minimal, rowvar=False)


def require(kind: str, scene: Mapping[str, Any]) -> Standing:
    """The rail of a resolved scene. Raises SceneError for a fault of it, and for an unknown
    format."""
    if kind not in FORMATS:
        raise SceneError([Fault("export", "format", repr(kind), " or ".join(FORMATS))])
    return standing(scene)


def require_fixed(keys: Iterable[str]) -> None:
    """Raise SceneError if the ``keys`` that cases vary move the rail."""
    wrong = [key for key in keys if key.split(".")[0] in ("gravity", "hand_over")]
    if wrong:
        expected = "the same rail in all cases, for a mean state"
        raise SceneError([Fault("export", key, "a distribution", expected) for key in wrong])


def write(kind: str, path: str | Path, scene: Mapping[str, Any], found: Any) -> Standing:
    """Write the state at exit of an outcome ``found``, or mean and covariance of columns of outcomes.

    ``kind``: "rocketpy" for JSON, or "csv". ``scene`` is the resolved scene. Returns the rail, with
    what is assumed of it. Raises SceneError.
    """
    rail = require(kind, scene)
    solutions = initial_solution(at_exit(found), rail)
    titles = [f"{name} [{unit}]" for name, unit in COMPONENTS.items()]
    if solutions.ndim == 1:
        if kind == "csv":
            write_csv(path, dict(zip(titles, solutions[:, None])))
        else:
            content = {"initial_solution": solutions.tolist(), "components": COMPONENTS}
            write_json(path, content | _described(scene, rail))
        return rail
    if len(solutions) < 2:
        raise SceneError([Fault("export", "cases", "1 with a state at exit", "at least 2")])
    mean, covariance = mean_and_covariance(solutions)
    if kind == "csv":
        write_text(path, _table(mean, covariance))
    else:
        content = {
            "cases": len(solutions),
            "mean": mean.tolist(),
            "components": COMPONENTS,
            "covariance": covariance.tolist(),
            "covariance_components": MINIMAL,
        }
        write_json(path, content | _described(scene, rail))
    return rail


def words(rail: Standing, path: str | Path) -> list[str]:
    """Lines on a written file: its path, the rail, and what is assumed of it."""
    inclination, heading = np.degrees([rail.inclination, rail.heading])
    stands = f"inclination {inclination:.6g} deg, heading {heading:.6g} deg"
    assumed = ", ".join(rail.assumed)
    return [
        f"state at exit: {path}, for a rail of {stands}",
        *([f"assumed: {assumed} (the table [hand_over] states it)"] if assumed else []),
    ]


def _described(scene: Mapping[str, Any], rail: Standing) -> dict[str, Any]:
    return {
        "axes": _AXES,
        "scene": scene["name"],
        "inclination_deg": float(np.degrees(rail.inclination)),
        "heading_deg": float(np.degrees(rail.heading)),
        "elevation_m": rail.elevation,
        "dry_mass_centre_m": rail.dry_mass_centre,
        "assumed": list(rail.assumed),
    }


def _table(mean: np.ndarray, covariance: np.ndarray) -> str:
    """Mean as one line, then the covariance, one line for each component."""
    lines = [
        ",".join(["component", *COMPONENTS]),
        ",".join(["mean", *map(repr, mean.tolist())]),
        ",".join(["covariance", *MINIMAL]),
        *(",".join([name, *map(repr, row)]) for name, row in zip(MINIMAL, covariance.tolist())),
    ]
    return "\n".join(lines) + "\n"
