"""A set of inputs as a scene file that extends another; every number has its provenance."""

from typing import Any

import numpy as np

from tipoff import toml
from tipoff.scenes import overrides, provenance
from tipoff.scenes.scene import Scene
from validation import published
from validation.paper import inputs

_UNITS = {
    "payload.mass": ("kg", 1.0),
    "payload.inertia": ("kg*m**2", 1.0),
    "rail.start": ("mm", 1e3),
    "rail.end": ("mm", 1e3),
    "contact.clearance": ("mm", 1e3),
    "contact.damping": ("N*s/mm", 1e-3),
    "contact.damping_depth": ("mm", 1e3),
    "thrust.peak": ("N", 1.0),
    "thrust.width": ("ms", 1e3),
    "thrust.centre": ("ms", 1e3),
    "thrust.arm": ("mm", 1e3),
    "initial.position": ("um", 1e6),
    "duration": ("ms", 1e3),
}
_PRINTED = ("contact.stiffness", "contact.damping", "contact.damping_depth")
_DIGITS = 9


def scene(base: Scene, found: dict[str, float], rates: np.ndarray) -> str:
    """TOML of a scene that extends ``base`` with the inputs ``found`` (``inputs.values``); settled
    ``rates`` (5,3) deg/s give the error in its description."""
    changed = inputs.overrides(base, found)
    error = np.abs(
        rates[[condition - 1 for condition in published.SENSITIVE]]
        - published.sensitivity().baseline
    ).max()
    exponent = _rounded(changed["contact.exponent"])
    table: dict[str, Any] = {
        "extends": base.name,
        "name": "paper_like",
        "description": "Inputs inferred so that the settled rates of the paper's Table 2 come out, "
        f"all nine within {error:.2g} deg/s.",
    }
    for key, value in changed.items():
        if _home(key) in _UNITS:
            overrides.apply(table, key, _quantity(key, value))
    table["rail"]["mounts"] = [
        {end: _in("mm", 1e3, item[end], 6) for end in ("start", "end")}
        for item in changed["rail.mounts"]
    ]
    table["contact"] |= {
        "exponent": exponent,
        "stiffness": f"{inputs.STIFFNESS:g} N/mm**{exponent:.{_DIGITS}g}",
    }
    table["friction"] = {
        name: _rounded(changed[f"friction.{name}"]) for name in ("static", "dynamic")
    }
    table["agreement"] = {
        "fitted": ["phi0", "phi15", "phi35", "phi60", "phi90"],
        "held_out": [],
        "floor": ["phi15"],
        "refined": ["phi35"],
    }
    inferred = {_home(key) for key in changed if key not in _PRINTED}
    printed = {key: provenance.nearest(base.provenance, key) for key in _PRINTED}
    table["provenance"] = dict.fromkeys(sorted(inferred), "inferred") | {
        key: text for key, text in printed.items() if text is not None
    }
    table["pads"] = [
        {
            "position": [
                _in("mm", 1e3, changed[f"pads.{number}.position.{axis}"]) for axis in range(3)
            ],
            "normals": list(pad.normals),
        }
        | {
            name: _in("mm", 1e3, getattr(pad, name))
            for name in ("length", "width", "inset", "relief")
        }
        for number, pad in enumerate(base.pads)
    ]
    return toml.dumps(table)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _quantity(key: str, value: float) -> str:
    return _in(*_UNITS[_home(key)], value)


def _in(unit: str, factor: float, value: float, digits: int = _DIGITS) -> str:
    return f"{factor * value:.{digits}g} {unit}"


def _home(key: str) -> str:
    """The key of units and provenance: one for the inertia, the position and the pads."""
    wholes = ("payload.inertia", "initial.position", "pads")
    return next((whole for whole in wholes if key.startswith(whole)), key)
