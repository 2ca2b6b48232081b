"""The uncertain inputs of a launcher from a file (by default ``tolerances.toml`` here), and the
cases at points of the unit cube.

The file is one of errors (``scenes.uncertainty``), whose keys that the scene does not have are left out.
Independent normal components y and z of an offset (``scenes.polar``) describe an unknown direction. Where
the exponent e of a contact law varies, the force at the reference penetration p_r of the calibration is
kept: k' = k p_r^(e - e'). Static friction varies in proportion to dynamic friction, unless it has its own
distribution.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tipoff.calibration.parameters import REFERENCE_PENETRATION
from tipoff.faults import Fault, SceneError
from tipoff.files import content_hash
from tipoff.lowfi.ensemble.derived import friction
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.scenes import overrides as keys
from tipoff.scenes import polar, reading, uncertainty
from tipoff.scenes.distributions import Distribution
from tipoff.scenes.effects.contact import LinearTable
from tipoff.scenes.scene import Scene

DEFAULT = Path(__file__).with_name("tolerances.toml")
_KINDS = ("vary", "factor")
_OF_DRAWS = ("cases", "seed", "sampling")  # what a file of errors states for random draws
_SPRINGS = (
    "contact.stiffness",
    "contact.exponent",
    "contact.damping",
    "contact.damping_depth",
    "contact.dissipation",
)


class Input(NamedTuple):
    """An uncertain input: its dotted key, whether the distribution is of a factor, the nominal
    value in the scene or None, unit (SI)."""

    key: str
    is_factor: bool
    distribution: Distribution
    nominal: float | None
    unit: str

    def values(self, probabilities: np.ndarray) -> np.ndarray:
        """Numbers (SI) at ``probabilities``, any shape."""
        drawn = self.distribution.ppf(probabilities)
        return drawn * self.nominal if self.is_factor else drawn


class Tolerances(NamedTuple):
    """Inputs that apply to a ``scene``, and the reason by key why an input does not."""

    scene: Scene
    inputs: list[Input]
    left_out: dict[str, str]

    def rows(self, probabilities: np.ndarray) -> list[dict[str, float]]:
        """Overrides (SI) of the cases at points (n, d) of the open unit cube."""
        found = {
            item.key: item.values(column) for item, column in zip(self.inputs, probabilities.T)
        }
        if "contact.exponent" in found:
            contact = self.scene.contact
            assert contact is not None  # an input of the exponent needs it
            stiffness = found.get("contact.stiffness", contact.stiffness)
            found["contact.stiffness"] = stiffness * REFERENCE_PENETRATION ** (
                contact.exponent - found["contact.exponent"]
            )
        if "friction.dynamic" in found and "friction.static" not in found:
            assert self.scene.friction is not None  # an input of the coefficient needs it
            if self.scene.friction.dynamic > 0.0:
                found |= friction(self.scene, found["friction.dynamic"])
        for key in list(found):
            if own := polar.component(
                key
            ):  # the other one is that of the scene, if it does not vary
                for axis in polar.COMPONENTS:
                    other = f"{own[0]}.{axis}"
                    if other not in found:
                        value = uncertainty.component_of(self.scene, other)
                        found[other] = np.full(len(probabilities), value)
        columns = polar.without_components({key: column.tolist() for key, column in found.items()})
        return [dict(zip(columns, values)) for values in zip(*columns.values())]


def digest(path: str | Path) -> str:
    """Hexadecimal digest of the content of a file. Raises SceneError where it cannot be read."""
    return content_hash(reading.toml(uncertainty.path_of(path), str(path)))


def load(path: str | Path, scene: Scene, model: str = COMPLIANT) -> Tolerances:
    """The tolerances of a file for ``scene`` and the surrogate ``model``. Raises SceneError listing
    every fault."""
    raw, source = reading.toml(uncertainty.path_of(path), str(path)), str(path)
    found: list[Input] = []
    left_out: dict[str, str] = {}
    known = ("description", *_OF_DRAWS, *_KINDS)
    faults = [
        Fault(source, key, "no such key", f"one of {', '.join(known)}")
        for key in raw
        if key not in known
    ]
    for kind, key, table in _tables(raw, source, faults):
        item = _input(source, kind, key, table, scene, faults)
        if item is None:
            continue
        if key in {other.key for other in found} | left_out.keys():
            faults.append(
                Fault(source, f"{kind}.{key}", "a second distribution", "one for each key")
            )
        elif reason := _idle(item, scene, model):
            left_out[key] = reason
        else:
            found.append(item)
    if not (found or faults):
        faults.append(
            Fault(
                source,
                "vary, factor",
                "no input that the scene has",
                "at least one number that varies",
            )
        )
    if faults:
        raise SceneError(faults)
    tolerances = Tolerances(scene, found, left_out)
    try:
        # finds faults that concern several keys
        scene.replace(tolerances.rows(np.full((1, len(found)), 0.5))[0])
    except SceneError as error:
        raise SceneError(
            [fault._replace(source=f"{source}, medians") for fault in error.faults]
        ) from None
    return tolerances


def _tables(raw: dict, source: str, faults: list[Fault]) -> list[tuple[str, str, dict[str, Any]]]:
    """(kind, key, table) of every distribution; the file may quote a key or nest it."""
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for kind in _KINDS:
        if not isinstance(raw.get(kind, {}), dict):
            faults.append(Fault(source, kind, repr(raw[kind]), "a table"))
            continue
        for dotted, value in keys.dotted(raw.get(kind, {})):
            key, _, name = dotted.rpartition(".")
            found.setdefault((kind, key), {})[name] = value
    return [(*place, table) for place, table in found.items()]


def _input(
    source: str, kind: str, key: str, table: dict, scene: Scene, faults: list[Fault]
) -> Input | None:
    distribution = uncertainty.distribution(source, kind, key, table, False, faults)
    if distribution is None:
        return None
    unit = uncertainty.unit_of(key) or ""
    return Input(key, kind == "factor", distribution, keys.held(scene, key), unit)


def _idle(item: Input, scene: Scene, model: str) -> str | None:
    """The reason why an input does not vary in this scene; None if it varies."""
    table = item.key.partition(".")[0]
    if table in ("contact", "friction") and getattr(scene, table) is None:
        return f"the scene has no {table}"
    if model == COMPLIANT and item.key in _SPRINGS:
        return "compliant contact has no such constant"
    if model == SPRINGS and item.key == "contact.interface_stiffness":
        return "only compliant contact uses it"
    if item.key == "contact.exponent" and isinstance(scene.contact, LinearTable):
        return "the law is linear"
    if item.nominal is None and (item.is_factor or table in ("contact", "friction", "thrust")):
        return "the scene has no such number"
    return (
        "the nominal value is zero, and a factor does not change it"
        if item.is_factor and item.nominal == 0.0
        else None
    )
