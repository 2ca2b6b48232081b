"""A launcher that turns while it ejects, and the same one looked at in inertial axes turned
anyhow."""

import numpy as np
from scipy.integrate import cumulative_trapezoid

from tipoff.kernels import rotation
from tipoff.mechanics import outcome

# of the other inertial axes, about no axis of the scene's
TURN = rotation.exponential((0.7, -1.1, 0.4))


def carried(rate, arm, along: float) -> dict:
    """``[initial]`` of a payload that turns with a platform at ``rate`` (3,) rad/s, ``arm`` (3,) m
    from its mass centre, and slides along the rail at ``along`` (m/s)."""
    velocity, turning = np.cross(rate, arm) + np.array([along, 0.0, 0.0]), dict(zip("xyz", rate))
    return {
        "velocity": dict(zip("xyz", velocity.tolist())),
        "rate": turning,
        "platform_rate": turning,
    }


def turned(vector: np.ndarray, turn=TURN) -> np.ndarray:
    """``vector`` (..., 3) turned by the quaternion ``turn``."""
    return vector @ rotation.matrices(np.array([turn]))[0].T


def seen_from_platform(run) -> dict[str, np.ndarray]:
    """Every sampled output that knows of no inertial axes, by name."""
    frame = rotation.matrices(run.platform_quaternion)
    forces = np.einsum("nji,nfj->nfi", frame, run.pad_force)
    return outcome.relative_motion(run) | {
        "rate": run.rate,
        "platform_rate": run.platform_rate,
        "pad_force": forces,
        "energy": run.energy,
    }


def differences(first, second) -> dict[str, float]:
    """Largest difference of two runs in each output seen from the platform, over its own largest
    value; of rates, the body's."""
    ours, theirs = seen_from_platform(first), seen_from_platform(second)
    sizes = {name: np.abs(values).max() for name, values in ours.items()}
    sizes["relative_rate"] = sizes["rate"]
    return {
        name: float(np.abs(theirs[name] - ours[name]).max() / size) for name, size in sizes.items()
    }


def largest_jump(angles: np.ndarray) -> float:
    """Largest change of any angle (n, ...) rad from one sample to the next."""
    return float(np.abs(np.diff(angles, axis=0)).max())


def turns(quaternion: np.ndarray) -> float:
    """Full turns between the first and the last of quaternions (n,4) of a body that turns about one
    axis, little in a sample."""
    steps = np.einsum("ni,ni->n", quaternion[1:], quaternion[:-1])
    return float(2.0 * np.arccos(np.clip(steps, -1.0, 1.0)).sum() / (2.0 * np.pi))


def principal(quaternion: np.ndarray) -> np.ndarray:
    """Rotation vectors (n,3) rad of quaternions (n,4), the shortest ones: what jumps at each half
    turn."""
    return np.array([rotation.vector(q) for q in quaternion])


def assert_smooth(run, interval: float, rate: float) -> None:
    """Between two samples ``interval`` (s) apart attitudes move by the bodies' ``rate`` (rad/s) and
    little more, and what is seen from the platform by a small part of its own size."""
    for quaternion in (run.quaternion, run.platform_quaternion):
        assert largest_jump(quaternion) <= 0.6 * rate * interval
    for name in (
        "relative_position",
        "relative_velocity",
        "relative_rate",
        "rate",
        "platform_rate",
    ):
        values = seen_from_platform(run)[name]
        assert (
            largest_jump(values) <= 0.05 * np.abs(run.rate if "rate" in name else values).max()
        ), name
    direction = np.arctan2(np.hypot(run.velocity[:, 1], run.velocity[:, 2]), run.velocity[:, 0])
    assert largest_jump(direction) <= 0.1


def without_frame(run) -> float:
    """Largest relative velocity (m/s) across the rail, computed without the turning of the frame,
    over the true one while on it."""
    frame = rotation.matrices(run.platform_quaternion)
    wrong = np.einsum("nji,nj->ni", frame, run.velocity - run.platform_velocity)
    true = outcome.relative_motion(run)["relative_velocity"]
    half = len(true) // 2
    return float(np.abs(wrong[:half, 1:]).max() / np.abs(true[:half, 1:]).max())


def impulses(run) -> np.ndarray:
    """Impulse (n,f,3) N s on each face up to each sample, in platform axes."""
    return cumulative_trapezoid(seen_from_platform(run)["pad_force"], run.time, axis=0)
