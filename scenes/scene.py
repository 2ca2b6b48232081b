"""The scene: one immutable, validated description that feeds both fidelities. Presence of a table is the switch.

>>> scene = load("reference")
>>> scene.replace({"thrust_offset.misalignment.axial": "0.3 deg"}).condition("phi35")
"""

import copy
import tomllib
from functools import cached_property
from pathlib import Path
from typing import Any, Mapping

from pydantic import Field, PrivateAttr, ValidationError

from scenes import plausibility
from scenes.effects.contact import ContactTable
from scenes.effects.friction import FrictionTable
from scenes.effects.gravity import GravityTable
from scenes.effects.initial import InitialTable
from scenes.effects.mass_offset import MassOffsetTable
from scenes.effects.platform import PlatformTable
from scenes.effects.thrust import ThrustTable
from scenes.effects.thrust_offset import ThrustOffsetTable
from scenes.faults import Fault, SceneError, faults_of
from scenes.files import content_hash
from scenes.table import Table
from scenes.tables import AgreementTable, OutputTable, PadTable, PayloadTable, RailTable
from scenes.units import PositiveTime

CATALOG = Path(__file__).resolve().parent / "catalog"
EFFECTS = ("thrust_offset", "mass_offset", "initial", "contact", "friction", "platform", "gravity")
_NOT_PHYSICS = {"name", "description", "conditions", "provenance", "agreement"}


class Scene(Table):
    """Everything a run needs. Fields are SI; an absent effect is None. Use ``replace`` for variations."""

    name: str
    description: str = ""
    duration: PositiveTime
    payload: PayloadTable
    pads: list[PadTable] = Field(min_length=1)
    rail: RailTable
    thrust: ThrustTable
    thrust_offset: ThrustOffsetTable | None = None
    mass_offset: MassOffsetTable | None = None
    initial: InitialTable | None = None
    contact: ContactTable | None = None
    friction: FrictionTable | None = None
    platform: PlatformTable | None = None
    gravity: GravityTable | None = None
    output: OutputTable = OutputTable()
    agreement: AgreementTable = AgreementTable()
    conditions: dict[str, dict[str, Any]] = Field(default_factory=dict)
    provenance: dict[str, str] = Field(default_factory=dict)
    _raw: dict = PrivateAttr(default_factory=dict)
    _source: str = PrivateAttr(default="scene")

    def replace(self, overrides: Mapping[str, Any]) -> "Scene":
        """A new scene with dotted keys set. Text carries units, a bare number is SI, None or "absent" drops a table.

        Raises SceneError listing every fault.
        """
        raw = copy.deepcopy(self._raw)
        unknown = [fault for key, value in overrides.items() if (fault := _set(raw, key, value))]
        if unknown:
            raise SceneError([Fault(self._source, *fault) for fault in unknown])
        return parse(raw, self._source, bare_numbers_are_si=True)

    def condition(self, name: str) -> "Scene":
        """The scene of one named condition. Raises SceneError for a name the scene does not have."""
        if name not in self.conditions:
            known = ", ".join(self.conditions) or "none are defined"
            raise SceneError([Fault(self._source, "conditions", repr(name), f"one of {known}")])
        return self.replace(self.conditions[name])

    def physics(self) -> dict:
        """The resolved physical inputs in SI, without names and roles: what a result depends on."""
        return self.model_dump(mode="json", exclude=_NOT_PHYSICS)

    def resolved(self) -> dict:
        """Every input in SI, as written into result files; ``parse`` reads it back."""
        return self.model_dump(mode="json", exclude_none=True)

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the physical inputs."""
        files = [Path(self.thrust.file).read_text()] if self.thrust.kind == "measured" else []
        return content_hash(self.physics(), files)

    @cached_property
    def warnings(self) -> list[str]:
        """Values that are allowed but implausible, by field name."""
        return plausibility.warnings(self)

    def absent_effects(self) -> list[str]:
        """Names of the effect tables this scene does not have."""
        return [name for name in EFFECTS if getattr(self, name) is None]


def parse(raw: Mapping[str, Any], source: str = "scene", bare_numbers_are_si: bool = False) -> Scene:
    """Validate a nested mapping. Raises SceneError listing every fault with file, key, given and expected."""
    try:
        scene = Scene.model_validate(raw, context={"bare_numbers_are_si": bare_numbers_are_si})
    except ValidationError as error:
        raise SceneError(faults_of(error, source)) from None
    scene._raw, scene._source = copy.deepcopy(dict(raw)), source
    _check_roles(scene)
    return scene


def load(name_or_path: str | Path) -> Scene:
    """Read a catalogue scene by name (``reference``) or a TOML file by path. Raises SceneError."""
    return parse(*_read(name_or_path))


def catalog() -> list[str]:
    """Names of the scenes that come with the package."""
    return sorted(path.stem for path in CATALOG.glob("*.toml"))


def _read(name_or_path: str | Path) -> tuple[dict, str]:
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = CATALOG / f"{name_or_path}.toml"
        if not path.is_file():
            raise SceneError([Fault(str(name_or_path), "scene", "an unknown name",
                                    f"a path to a .toml file or one of {', '.join(catalog())}")])
    try:
        with open(path, "rb") as stream:
            raw = tomllib.load(stream)
    except OSError as error:
        raise SceneError([Fault(str(path), "file", error.strerror, "a readable TOML file")]) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SceneError([Fault(str(path), "file", str(error), "valid TOML")]) from error
    thrust = raw.get("thrust")
    if isinstance(thrust, dict) and isinstance(thrust.get("file"), str):
        thrust["file"] = str(path.parent / thrust["file"])
    if base := raw.pop("extends", None):
        raw = _merge(_read(base)[0], raw)
    raw.setdefault("name", path.stem)
    return raw, str(path)


def _merge(base: dict, extra: dict) -> dict:
    merged = dict(base)
    for key, value in extra.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = _merge(merged[key], value) if both else value
    return merged


def _set(raw: dict, dotted: str, value: Any) -> tuple[str, str, str] | None:
    """Set one dotted key in place; returns (key, given, expected) when it leads nowhere."""
    *parents, last = dotted.split(".")
    table = raw
    for part in parents:
        if isinstance(table, list):
            if not (part.isdigit() and int(part) < len(table)):
                return dotted, part, f"an index below {len(table)}"
            table = table[int(part)]
        elif isinstance(table, dict):
            table = table.setdefault(part, {})
        else:
            return dotted, part, "a key inside a table"
    if isinstance(table, list) and last.isdigit() and int(last) < len(table):
        table[int(last)] = value
    elif not isinstance(table, dict):
        return dotted, last, "a key inside a table"
    elif value is None or value == "absent":
        table.pop(last, None)
    else:
        table[last] = value
    return None


def _check_roles(scene: Scene) -> None:
    faults = [Fault(scene._source, f"agreement.{role}", repr(name), "a name from [conditions]")
              for role, names in scene.agreement for name in names if name not in scene.conditions]
    if faults:
        raise SceneError(faults)
