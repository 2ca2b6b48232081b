"""A small valid scene as a mapping, and motions with closed forms."""

import copy

import numpy as np
import pytest

from tipoff.mechanics import ledger
from tipoff.mechanics.outcome import Outcome
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import SceneError, parse

SMALL = {
    "name": "small",
    "duration": "30 ms",
    "payload": {
        "mass": "10 kg",
        "inertia": {"xx": "1 kg*m**2", "yy": "1.1 kg*m**2", "zz": "1.2 kg*m**2"},
    },
    "pads": [{"position": ["0 m", "0.1 m", "0.1 m"], "normals": ["+y", "+z"]}],
    "rail": {
        "start": "-0.1 m",
        "end": "0.1 m",
        "material": {"density": "2810 kg/m**3", "youngs_modulus": "72 GPa", "poisson_ratio": 0.33},
    },
    "thrust": {"kind": "gaussian", "peak": "6 kN", "width": "4 ms", "centre": "12 ms"},
}
CONTACT = {
    "law": "impact",
    "clearance": "0.1 mm",
    "stiffness": "70000 N/mm**1.5",
    "damping": "60 N*s/mm",
    "damping_depth": "0.3 mm",
}
FRICTION = {"static": 0.2, "dynamic": 0.1, "static_speed": "10 mm/s", "dynamic_speed": "20 mm/s"}
STICKING = {
    "law": "sticking",
    "static": 0.4,
    "dynamic": 0.3,
    "stiffness": "1e4 N/mm",
    "damping": "10 N*s/mm",
}


def small(**tables) -> dict:
    """The small scene with whole tables or keys replaced; keys with two underscores reach into
    tables."""
    raw = copy.deepcopy(SMALL)
    for key, value in tables.items():
        *parents, last = key.split("__")
        table = raw
        for part in parents:
            table = table.setdefault(part, {})
        table[last] = value
    return raw


def motion(
    position,
    velocity=None,
    quaternion=None,
    rate=None,
    time=None,
    platform_rate=None,
    platform_quaternion=None,
    status="time_limit",
    **parts,
) -> Trajectory:
    """A trajectory of given samples; what is not given is zero, aligned, or at rest."""
    position = np.asarray(position, dtype=float)
    n = len(position)
    zeros, aligned = np.zeros((n, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    entries = dict(
        model="springs",
        status=status,
        time=time,
        position=position,
        velocity=zeros if velocity is None else velocity,
        quaternion=aligned if quaternion is None else quaternion,
        rate=zeros if rate is None else rate,
        platform_position=zeros,
        platform_velocity=zeros,
        platform_rate=np.zeros((n, 3)) if platform_rate is None else platform_rate,
        platform_quaternion=aligned if platform_quaternion is None else platform_quaternion,
        pad_force=np.zeros((n, 2, 3)),
        energy=np.zeros((n, len(ledger.ENTRIES))),
        transverse_energy=np.zeros((n, len(ledger.ENTRIES))),
        outcome=Outcome(),
        checks={},
        cost={},
        scene={},
    )
    return Trajectory(**entries | parts)


def refused(raw) -> list:
    """Faults of a scene that must be refused."""
    with pytest.raises(SceneError) as caught:
        parse(raw, "file.toml")
    return caught.value.faults


def write(folder, name, text):
    """A file of this text."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
