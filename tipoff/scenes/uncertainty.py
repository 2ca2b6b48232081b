"""Inputs of an ensemble from a TOML file: distributions under dotted keys, number of cases, seed,
sampling method::

    cases = 1000
    seed = 1
    sampling = "sobol"                     # or "latin-hypercube", "random"

    [vary."thrust_offset.misalignment.axial"]
    distribution = "normal"     # fixed, uniform, log-uniform ...: see distributions.py
    mean = "0 deg"
    sd = "0.033 deg"

    [factor."thrust.peak"]      # of the value that the scene has
    distribution = "normal"
    mean = "1"
    sd = "0.02"

A scene has the nominal values, this file their uncertainty. Quantities have the dimension of their
key in the scene. An offset has the keys axial and radial, or y and z (``scenes.polar``).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, ValidationError, model_validator

from tipoff.faults import Fault, SceneError, close
from tipoff.scenes import overrides as keys
from tipoff.scenes import polar, reading
from tipoff.scenes.distributions import BY_NAME, Distribution, fixed
from tipoff.scenes.faults import faults_of, renamed, within
from tipoff.scenes.scene import Scene
from tipoff.scenes.table import Table

CATALOG = reading.CATALOG / "vary"
DEFAULT = "paper"
_RARE = 1e-5  # probability beyond each end of a range
_FAR = 0.5  # of the width of a range


class _File(Table):
    description: str = ""
    cases: Annotated[int, Field(strict=True, gt=0, le=2**40)] = 10_000
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = 1
    sampling: Literal["random", "latin-hypercube", "sobol"] = "random"
    vary: dict[str, Any] = Field(default_factory=dict)
    factor: dict[str, Any] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _varies(self):
        if not (self.vary or self.factor):
            raise within("vary, factor", "nothing", "at least one key that varies")
        return self


class Uncertainty(NamedTuple):
    """Inputs of an ensemble."""

    cases: int  # to be drawn
    seed: int
    sampling: str
    vary: dict[str, Distribution]  # by dotted key, or by that of a component of an offset
    #: nominal values (SI) by the keys whose factor is drawn
    factors: Mapping[str, float] = MappingProxyType({})

    def resolved(self) -> dict:
        """The inputs of the sampling in SI, as written into result files."""
        drawn = {
            key: item.model_dump(mode="json", exclude={"provenance"})
            | ({"factor_of": self.factors[key]} if key in self.factors else {})
            for key, item in self.vary.items()
        }
        return {name: getattr(self, name) for name in ("cases", "seed", "sampling")} | {
            "vary": drawn
        }

    def overrides(self, drawn: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
        """Overrides (SI) of a scene, (n,) by dotted key, from the numbers (n,) that are ``drawn`` by the
        keys of ``vary``."""
        scaled = {
            key: [self.factors[key] * number for number in column]
            if key in self.factors
            else column
            for key, column in drawn.items()
        }
        return polar.without_components(scaled)


@dataclass(frozen=True, kw_only=True)
class Varied:
    """``Uncertainty.resolved`` in a result."""

    cases: int
    seed: int
    sampling: str
    vary: dict[str, dict]


def chosen(vary: str | None, scene: Scene) -> str:
    """The name or path of a file of errors: that which is given, else that of the ``scene``
    (studies.errors), else ``DEFAULT``."""
    return vary or (scene.studies and scene.studies.errors) or DEFAULT


def of_scene(scene: Scene, **changed: Any) -> Uncertainty | None:
    """The random errors of ``scene`` under ``studies.errors``, read as ``load`` does; None without
    errors. Raises SceneError with every fault."""
    stated = scene.studies and scene.studies.errors
    return load(stated, scene, **changed) if stated else None


def load(name_or_path: str | Path, scene: Scene, **changed: Any) -> Uncertainty:
    """Read the uncertain inputs of ``scene`` from a TOML file, or from the catalogue by name;
    ``changed`` replaces cases, seed or sampling.

    Raises SceneError with every fault.
    """
    path = path_of(name_or_path)
    return parse(reading.toml(path, str(path)) | changed, scene, str(path))


def path_of(name_or_path: str | Path) -> Path:
    """The path of a file of errors: a .toml file, or one of the catalogue by name. Raises SceneError."""
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = CATALOG / f"{name_or_path}.toml"
        if not path.is_file():
            names = sorted(item.stem for item in CATALOG.glob("*.toml"))
            known = f"{', '.join(names)}{close(str(name_or_path), names)}"
            raise SceneError(
                [
                    Fault(
                        str(name_or_path),
                        "vary",
                        "an unknown name",
                        f"a path to a .toml file or one of {known}",
                    )
                ]
            )
    return path


def parse(
    raw: Mapping[str, Any], scene: Scene, source: str = "vary", bare_numbers_are_si: bool = False
) -> Uncertainty:
    """Validate the mapping of a file. Raises SceneError with every fault: file, key, given and
    expected."""
    faults: list[Fault] = []
    try:
        file = _File.model_validate(raw, context={})
    except ValidationError as error:
        faults = faults_of(error, source)
    found: dict[str, Distribution] = {}
    factors: dict[str, float] = {}
    for kind in ("vary", "factor"):
        for key, table in _tables(raw.get(kind)).items():
            item = distribution(source, kind, key, table, bare_numbers_are_si, faults)
            if key in found:
                faults.append(Fault(source, f"factor.{key}", "also under vary", "one of both"))
            if item is None:
                continue
            found[key] = item
            if kind == "factor":
                own = keys.held(scene, key)
                if not isinstance(own, float):
                    expected = "a key that has a number in the scene"
                    faults.append(Fault(source, f"factor.{key}", repr(own), expected))
                else:
                    factors[key] = own
    faults += _both_forms(found, source)
    if faults:
        raise SceneError(faults)
    made = Uncertainty(file.cases, file.seed, file.sampling, _whole_offsets(found, scene), factors)
    try:
        # A scene of the medians shows faults that no single key shows, such as an absent pad.
        middles = {key: [float(item.ppf(np.array(0.5)))] for key, item in made.vary.items()}
        scene.replace({key: column[0] for key, column in made.overrides(middles).items()})
    except SceneError as error:
        raise SceneError(
            [fault._replace(source=f"{source}, medians") for fault in error.faults]
        ) from None
    return made


def _both_forms(found: Mapping[str, Distribution], source: str) -> list[Fault]:
    """Faults of offsets with axial or radial and with components too."""
    tables = dict.fromkeys(own[0] for key in found if (own := polar.component(key)))
    return [
        Fault(source, f"vary.{key}", "beside y or z", "axial and radial, or y and z")
        for table in tables
        for key in (f"{table}.axial", f"{table}.radial")
        if key in found
    ]


def _whole_offsets(found: dict[str, Distribution], scene: Scene) -> dict[str, Distribution]:
    """``found`` with both components of each offset that has one: that of the scene where it does not
    vary."""
    made = dict(found)
    for key in found:
        if own := polar.component(key):
            for axis in polar.COMPONENTS:
                value = component_of(scene, f"{own[0]}.{axis}")
                made.setdefault(f"{own[0]}.{axis}", fixed(value))
    return made


def component_of(scene: Scene, key: str) -> float:
    """The component (SI) of an offset of ``scene`` under the dotted ``key``; zero without the offset."""
    found = polar.component(key)
    assert found is not None
    table, axis = found
    size, angle = (keys.held(scene, f"{table}.{name}") or 0.0 for name in ("axial", "radial"))
    return polar.components(table, size, angle)[axis]


def far_from_scene(found: Uncertainty, scene: Scene) -> list[str]:
    """Messages on distributions whose range is far from the value of ``scene``, by more than half of its
    width: those of another scene, perhaps. A fixed value is meant."""
    messages = []
    for key, item in found.vary.items():
        own = component_of(scene, key) if polar.component(key) else keys.held(scene, key)
        if key in found.factors or not isinstance(own, float) or item.distribution == "fixed":
            continue
        low, high = (float(item.ppf(np.array(share))) for share in (_RARE, 1.0 - _RARE))
        if max(low - own, own - high) > _FAR * (high - low):
            unit = unit_of(key) or ""
            messages.append(
                f"vary.{key}: {low:.4g} to {high:.4g} {unit} in nearly all cases, and {own:.4g} {unit} in the "
                "scene; the errors may be those of another scene"
            )
    return messages


def _tables(vary: Any) -> dict[str, dict[str, Any]]:
    """Tables of distributions by dotted key, for quoted and nested keys of a file."""
    found: dict[str, dict[str, Any]] = {}
    for dotted, value in keys.dotted(vary if isinstance(vary, dict) else {}):
        key, _, name = dotted.rpartition(".")
        found.setdefault(key, {})[name] = value
    return found


def unit_of(key: str) -> str | None:
    """SI unit of the number under a dotted key of a file of errors; None without a number."""
    return keys.unit(Scene, polar.stored(key))


def distribution(
    source: str, kind: str, key: str, table: dict[str, Any], bare: bool, faults: list[Fault]
) -> Distribution | None:
    """The distribution of a ``table`` under ``key``, of the kind "vary" or "factor"; None with a new entry
    of ``faults``."""
    place = f"{kind}.{key}"
    if (unit := unit_of(key)) is None:
        known = keys.is_key(Scene, key)
        expected = renamed(key) or ("a key that holds a number" if known else "no such key")
        faults.append(Fault(source, place, repr(table), expected))
        return None
    name = table.get("distribution")
    if name not in BY_NAME:
        faults.append(
            Fault(source, f"{place}.distribution", repr(name), f"one of {', '.join(BY_NAME)}")
        )
        return None
    context = {"unit": "dimensionless" if kind == "factor" else unit, "bare_numbers_are_si": bare}
    try:
        return BY_NAME[name].model_validate(table, context=context)
    except ValidationError as error:
        faults += [fault._replace(key=f"{place}.{fault.key}") for fault in faults_of(error, source)]
        return None
