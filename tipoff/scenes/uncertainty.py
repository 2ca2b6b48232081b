"""Inputs of an ensemble from a TOML file: distributions under dotted keys, number of cases, seed,
sampling method::

    cases = 1000
    seed = 1
    sampling = "sobol"                     # or "latin-hypercube", "random"

    [vary."thrust_offset.misalignment.axial"]
    distribution = "normal"     # fixed, uniform, log-uniform ...: see distributions.py
    mean = "0 deg"
    sd = "0.033 deg"

A scene has the nominal values, this file their uncertainty. Quantities have the dimension of their
key in the scene.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import AfterValidator, Field, ValidationError

from tipoff.faults import Fault, SceneError, close
from tipoff.scenes import overrides as keys
from tipoff.scenes import reading
from tipoff.scenes.distributions import BY_NAME, Distribution
from tipoff.scenes.faults import faults_of, renamed
from tipoff.scenes.scene import Scene
from tipoff.scenes.table import Table, at_least_one

CATALOG = reading.CATALOG / "vary"
DEFAULT = "paper"
_RARE = 1e-5  # probability beyond each end of a range
_FAR = 0.5  # of the width of a range


class _File(Table):
    description: str = ""
    cases: Annotated[int, Field(strict=True, gt=0, le=2**40)]
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = 1
    sampling: Literal["random", "latin-hypercube", "sobol"] = "random"
    vary: Annotated[dict[str, Any], AfterValidator(at_least_one)]


class Uncertainty(NamedTuple):
    """Inputs of an ensemble."""

    cases: int  # to be drawn
    seed: int
    sampling: str
    vary: dict[str, Distribution]  # by dotted key

    def resolved(self) -> dict:
        """The inputs of the sampling in SI, as written into result files."""
        return self._asdict() | {
            "vary": {
                key: item.model_dump(mode="json", exclude={"provenance"})
                for key, item in self.vary.items()
            }
        }


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
    return parse(reading.toml(path, str(path)) | changed, scene, str(path))


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
    tables = _tables(raw.get("vary"))
    found = {
        key: _distribution(source, key, table, bare_numbers_are_si, faults)
        for key, table in tables.items()
    }
    if faults:
        raise SceneError(faults)
    varied = {key: item for key, item in found.items() if item is not None}
    try:
        # A scene of the medians shows faults that no single key shows, such as an absent pad.
        scene.replace({key: float(item.ppf(np.array(0.5))) for key, item in varied.items()})
    except SceneError as error:
        raise SceneError(
            [fault._replace(source=f"{source}, medians") for fault in error.faults]
        ) from None
    return Uncertainty(file.cases, file.seed, file.sampling, varied)


def far_from_scene(found: Uncertainty, scene: Scene) -> list[str]:
    """Messages on distributions whose range is far from the value of ``scene``, by more than half of its
    width: those of another scene, perhaps. A fixed value is meant."""
    messages = []
    for key, item in found.vary.items():
        own = keys.held(scene, key)
        if not isinstance(own, float) or item.distribution == "fixed":
            continue
        low, high = (float(item.ppf(np.array(share))) for share in (_RARE, 1.0 - _RARE))
        if max(low - own, own - high) > _FAR * (high - low):
            unit = keys.unit(Scene, key) or ""
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


def _distribution(
    source: str, key: str, table: dict[str, Any], bare: bool, faults: list[Fault]
) -> Distribution | None:
    place = f"vary.{key}"
    if (unit := keys.unit(Scene, key)) is None:
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
    try:
        return BY_NAME[name].model_validate(
            table, context={"unit": unit, "bare_numbers_are_si": bare}
        )
    except ValidationError as error:
        faults += [fault._replace(key=f"{place}.{fault.key}") for fault in faults_of(error, source)]
        return None
