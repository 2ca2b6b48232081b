"""Random valid scenes for property tests, and the same scene mirrored, rotated or with its pads in
another order.

Every scene has one of five sets of effects, since each set is one more kernel to compile; within a
set all numbers vary. Under an orthogonal matrix S polar vectors (places, velocities, forces) become
S v, axial ones (rates, rotation vectors) det(S) S v.
"""

import math

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from tests.lowfi.support import with_neutral_effects
from tipoff.kernels import rotation
from tipoff.scenes import parse
from tipoff.scenes.body import InertiaTensor, tensor
from tipoff.scenes.scene import Scene

MIRROR = np.diag([1.0, -1.0, 1.0])
QUARTER_TURN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
EFFECTS = {  # contact law, then the tables that are present
    "ejection": ("impact", "friction", "platform", "thrust_offset", "pulse"),
    "guided": ("linear", "friction", "gravity", "thrust_offset"),
    "frictionless": ("hunt-crossley",),
    "free": (None, "thrust_offset"),
    "everything": ("hunt-crossley", "friction", "gravity", "platform", "thrust_offset", "pulse"),
}
DURATION, INTERVAL = 0.03, 5e-4
_LENGTH = {"start": -100.0, "end": 100.0}
_ENTRIES = (("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2))


def _number(low: float, high: float):
    return st.floats(low, high, allow_subnormal=False)


def _vector(size: float):
    return st.tuples(*[_number(-size, size)] * 3).map(lambda values: dict(zip("xyz", values)))


@st.composite
def _inertias(draw, low: float, high: float):
    """Principal moments b + c, c + a, a + b of a body with these second moments of mass, turned
    anyhow."""
    a, b, c = (draw(_number(low, high)) for _ in range(3))
    turn = rotation.matrices(np.array([rotation.exponential(tuple(draw(_vector(3.0)).values()))]))[
        0
    ]
    return _table(turn @ np.diag([b + c, c + a, a + b]) @ turn.T)


def _table(matrix: np.ndarray) -> dict:
    return {name: float(matrix[i, j]) for name, i, j in _ENTRIES}


@st.composite
def _pads(draw):
    """Two to eight pads at corners of the payload, each with one or both of its outward faces, some
    ahead and some behind."""
    pads = []
    for number in range(draw(st.integers(2, 8))):
        x = draw(_number(0.02, 0.12)) * (1 if number % 2 else -1)
        y, z = (draw(_number(0.03, 0.12)) * draw(st.sampled_from((-1, 1))) for _ in range(2))
        normals = ["+y" if y > 0 else "-y", "+z" if z > 0 else "-z"]
        pads.append(
            {
                "position": (x, y, z),
                "normals": draw(st.sampled_from((normals, normals[:1], normals[1:]))),
            }
        )
    return pads


@st.composite
def _contacts(draw, law: str, lossless: bool):
    """A law with 0.1 to 5 kN at 50 um, undamped or damped up to twice what stops a body of the
    payload's size."""
    exponent = 1.0 if law == "linear" else draw(st.sampled_from((1.0, 1.5, 2.2)))
    table = {
        "law": law,
        "clearance": draw(st.sampled_from((0.0, 5e-5, 3e-4))),
        "exponent": exponent,
        "stiffness": draw(_number(100.0, 5000.0)) / 5e-5**exponent,
    }
    damping = 0.0 if lossless else draw(st.sampled_from((0.0, 1.0))) * draw(_number(0.1, 2.0))
    if law == "hunt-crossley":
        return table | {"dissipation": 10.0 * damping}
    return table | {"damping": 1e4 * damping} | ({"damping_depth": 3e-4} if law == "impact" else {})


def _eccentricity(radius: float):
    return st.fixed_dictionaries(
        {"axial": _number(0.0, radius), "radial": _number(-math.pi, math.pi)}
    )


@st.composite
def _frictions(draw, lossless: bool):
    mu, speed = (
        0.0 if lossless else draw(st.sampled_from((0.0, 1.0))) * draw(_number(0.05, 0.6)),
        draw(_number(2e-3, 2e-2)),
    )
    return {
        "static": mu,
        "dynamic": mu * draw(_number(0.5, 1.0)),
        "static_speed": speed,
        "dynamic_speed": 2.0 * speed,
    }


@st.composite
def raw_scenes(draw, kind: str, lossless: bool = False) -> dict:
    """A mapping that ``scenes.parse`` takes, in SI numbers. ``lossless``: undamped, without
    friction, thrust that varies or rail ends."""
    law, *present = EFFECTS[kind]
    force = draw(st.sampled_from((0.0, 1.0))) * draw(_number(100.0, 6000.0))
    thrust = {"kind": "constant", "force": force, "duration": 1.0}
    if "pulse" in present:
        thrust = {
            "kind": "gaussian",
            "peak": 0.0 if lossless else force,
            "width": draw(_number(5e-4, 4e-3)),
            "centre": draw(_number(0.0, 0.02)),
        }
    initial = {
        "position": draw(_vector(5e-5)),
        "attitude": draw(_vector(1e-3)),
        "rate": draw(_vector(0.5)),
        "velocity": draw(_vector(0.05)) | {"x": draw(_number(0.0, 5.0))},
    }
    rail = _LENGTH if lossless else draw(st.sampled_from((_LENGTH, {"start": -0.2, "end": 0.15})))
    raw = {
        "name": kind,
        "duration": DURATION,
        "output": {"interval": INTERVAL},
        "pads": draw(_pads()),
        "payload": {"mass": draw(_number(2.0, 30.0)), "inertia": draw(_inertias(0.005, 0.3))},
        "thrust": thrust,
        "initial": initial,
        "rail": rail
        | {"material": {"density": 2810.0, "youngs_modulus": 72e9, "poisson_ratio": 0.33}},
    }
    if law:
        raw["contact"] = draw(_contacts(law, lossless))
    if "friction" in present:
        raw["friction"] = draw(_frictions(lossless))
    if "gravity" in present:
        raw["gravity"] = draw(_vector(10.0))
    if "platform" in present:
        raw["platform"] = {
            "mass": draw(_number(20.0, 300.0)),
            "inertia": draw(_inertias(0.5, 10.0)),
            "mass_centre": draw(_vector(0.2)),
        }
        initial |= {"platform_velocity": draw(_vector(0.05)), "platform_rate": draw(_vector(0.1))}
        thrust |= {"reaction": draw(st.sampled_from(("platform", "exhaust")))}
    if "thrust_offset" in present:
        raw["thrust_offset"] = {
            "misalignment": {
                "axial": draw(_number(0.0, 0.02)),
                "radial": draw(_number(-math.pi, math.pi)),
            },
            "eccentricity": draw(_eccentricity(5e-3)),
        }
        raw["mass_offset"] = {"eccentricity": draw(_eccentricity(1e-3))}
    return raw


def scene_of(raw: dict) -> Scene:
    """The validated scene."""
    return parse(with_neutral_effects(raw), bare_numbers_are_si=True)


def transformed(raw: dict, matrix: np.ndarray) -> dict:
    """The same scene seen in axes changed by an orthogonal ``matrix`` (3,3) that keeps x and maps y
    and z axes onto axes."""
    axial = np.linalg.det(matrix) * matrix
    new = raw | {
        "pads": [_turned_pad(pad, matrix) for pad in raw["pads"]],
        "payload": _turned_body(raw["payload"], matrix),
        "initial": {
            name: _turned(
                vector, axial if name in ("attitude", "rate", "platform_rate") else matrix
            )
            for name, vector in raw["initial"].items()
        },
    }
    if "gravity" in raw:
        new["gravity"] = _turned(raw["gravity"], matrix)
    if "platform" in raw:
        new["platform"] = _turned_body(raw["platform"], matrix) | {
            "mass_centre": _turned(raw["platform"]["mass_centre"], matrix)
        }
    if "thrust_offset" in raw:
        tilt = raw["thrust_offset"]["misalignment"]
        across = matrix @ [0.0, math.cos(tilt["radial"]), math.sin(tilt["radial"])]
        new["thrust_offset"] = {
            "misalignment": tilt | {"radial": math.atan2(across[2], across[1])},
            "eccentricity": _turned_eccentricity(raw["thrust_offset"]["eccentricity"], matrix),
        }
        new["mass_offset"] = {
            "eccentricity": _turned_eccentricity(raw["mass_offset"]["eccentricity"], matrix)
        }
    return new


def _turned(vector: dict, matrix: np.ndarray) -> dict:
    return dict(zip("xyz", (matrix @ list(vector.values())).tolist()))


def _turned_pad(pad: dict, matrix: np.ndarray) -> dict:
    names = {}
    for sign, mark in ((1.0, "+"), (-1.0, "-")):
        for axis in (1, 2):
            image = matrix @ (sign * np.eye(3)[axis])
            to = int(np.argmax(np.abs(image)))
            names[mark + "xyz"[axis]] = ("+" if image[to] > 0 else "-") + "xyz"[to]
    return {
        "position": tuple((matrix @ pad["position"]).tolist()),
        "normals": [names[normal] for normal in pad["normals"]],
    }


def _turned_body(body: dict, matrix: np.ndarray) -> dict:
    return body | {
        "inertia": _table(
            matrix @ tensor(InertiaTensor.model_construct(**body["inertia"])) @ matrix.T
        )
    }


def _turned_eccentricity(eccentricity: dict, matrix: np.ndarray) -> dict:
    across = matrix @ [0.0, math.sin(eccentricity["radial"]), math.cos(eccentricity["radial"])]
    return eccentricity | {"radial": math.atan2(across[1], across[2])}


def independent(kind: str, seeds) -> list[dict]:
    """One scene for each of ``seeds``, drawn separately: successive examples of Hypothesis resemble
    each other."""
    found = []
    for number in seeds:
        drawn = []

        @seed(number)
        @settings(
            max_examples=2,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(raw=raw_scenes(kind))
        def draw(raw):
            drawn.append(raw)  # noqa: B023  called at once

        draw()
        found.append(drawn[-1])  # the first one is always the simplest there is
    return found
