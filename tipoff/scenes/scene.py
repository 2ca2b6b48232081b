"""The scene: an immutable, validated description of an ejection for both solvers. The presence of
its table switches an effect on.

>>> scene = load("reference")
>>> scene.replace({"thrust_offset.misalignment.axial": "0.3 deg"}).condition("phi35")
"""

from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tipoff.faults import Fault, SceneError, close
from tipoff.mechanics.run_limits import MOST_SAMPLES
from tipoff.scenes import (
    inputs,
    launch,
    names,
    pads,
    plausibility,
    provenance,
    reading,
    roles,
    shown,
    suggestions,
    unchanged,
)
from tipoff.scenes import overrides as keys
from tipoff.scenes.effects.contact import ContactTable
from tipoff.scenes.effects.flight import FlightTable
from tipoff.scenes.effects.friction import FrictionTable
from tipoff.scenes.effects.gravity import GravityTable
from tipoff.scenes.effects.hand_over import HandOverTable
from tipoff.scenes.effects.hold_down import HoldDownTable
from tipoff.scenes.effects.initial import InitialTable
from tipoff.scenes.effects.mass_offset import MassOffsetTable
from tipoff.scenes.effects.platform import PlatformTable
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.effects.thermal import ThermalTable
from tipoff.scenes.effects.thrust import ThrustTable
from tipoff.scenes.effects.thrust_offset import ThrustOffsetTable
from tipoff.scenes.faults import faults_of, within
from tipoff.scenes.names import NOMINAL
from tipoff.scenes.parts import expansion
from tipoff.scenes.parts.body import Origin
from tipoff.scenes.parts.buttons import ButtonTable
from tipoff.scenes.parts.deployer import DeployerTable
from tipoff.scenes.parts.lugs import LugTable
from tipoff.scenes.rail import RailTable
from tipoff.scenes.studies import StudiesTable
from tipoff.scenes.table import MOST, Table, at_least_one, is_absent, limited
from tipoff.scenes.tables import AgreementTable, OutputTable, PadTable, PayloadTable
from tipoff.scenes.units import Duration

CATALOG = reading.CATALOG
_BESIDE = ("conditions", "agreement", "provenance")


class Scene(inputs.Inputs, shown.Shown, launch.Timed, Table):
    """Everything a run needs, in SI; an absent effect is None. ``replace`` makes variations.

    Example:
        >>> scene = tipoff.load("tiny")
        >>> scene.duration  # s
        0.025
    """

    #: Name of the scene and of its folder of results: letters, digits, -, _ and .
    name: Annotated[str, AfterValidator(names.of_scene)]
    #: One line for lists and reports.
    description: str = ""
    #: Longest time that is simulated. Without it a run ends when it is settled or jammed.
    duration: Duration | None = None
    #: Point from which the places of buttons, lugs, pads, mass centre, rail and mounts are counted: the
    #: tail (forwards) or the nose (backwards) of the payload; its mass centre where absent.
    origin: Origin | None = Field(None, exclude=True)
    #: The rigid body that leaves the rail.
    payload: PayloadTable
    #: Rail buttons in the slot of a T-slot rail, in place of pads.
    buttons: Annotated[tuple[ButtonTable, ...], limited] | None = Field(None, exclude=True)
    #: Launch lugs on a round rod, in place of pads.
    lugs: Annotated[tuple[LugTable, ...], limited] | None = Field(None, exclude=True)
    #: A CubeSat in its deployer, in place of pads, rail and what else follows from its form.
    deployer: DeployerTable | None = Field(None, exclude=True)
    #: The blocks on the payload that slide along the rail.
    pads: Annotated[tuple[PadTable, ...], limited, AfterValidator(at_least_one)]
    #: The elastic guide: the built-in L section, a mesh file or a CAD solid.
    rail: RailTable
    #: The force of the thruster over time, or of springs over launch.
    thrust: ThrustTable
    #: Errors of the direction and of the line of the thrust.
    thrust_offset: ThrustOffsetTable | None = None
    #: Error of the place of the mass centre.
    mass_offset: MassOffsetTable | None = None
    #: State of payload and platform at ignition.
    initial: InitialTable | None = None
    #: Latch that holds the travel until the thrust reaches a value, or until a time.
    hold_down: HoldDownTable | None = Field(None, exclude_if=is_absent)
    #: Clearance, contact law and interface stiffness.
    contact: ContactTable | None = None
    #: Friction between pads and walls.
    friction: FrictionTable | None = None
    #: The free rigid body that carries the rails.
    platform: PlatformTable | None = None
    #: Uniform acceleration of every body.
    gravity: GravityTable | None = None
    #: Flight in orbit after the exit.
    flight: FlightTable | None = None
    #: How the rail stands on the ground, for files of the state at exit.
    hand_over: HandOverTable | None = Field(None, exclude_if=is_absent)
    #: Temperature of the rails.
    thermal: ThermalTable | None = Field(None, exclude_if=is_absent)
    #: Sampling of the results.
    output: OutputTable = Field(OutputTable(), validate_default=True)
    #: What the studies use unless an option replaces it.
    studies: StudiesTable | None = Field(None, exclude_if=is_absent)
    #: Roles of the conditions, and limits of agreement.
    agreement: AgreementTable = AgreementTable()
    #: Named conditions: dotted keys with other values; "absent" removes a table.
    conditions: Annotated[dict[str, dict[str, Any]], limited] = Field(default_factory=dict)
    #: Source of values, under the dotted key of the value or of its table.
    provenance: Annotated[dict[str, str], limited] = Field(default_factory=dict)
    _raw: dict = PrivateAttr(default_factory=dict)
    _source: str = PrivateAttr(default="scene")

    @field_validator("thrust")
    @classmethod
    def _within_the_rail(cls, thrust: ThrustTable, info: ValidationInfo):
        return launch.with_strokes_on_the_rail(thrust, info.data)

    @field_validator("thermal")
    @classmethod
    def _expanding(cls, thermal: ThermalTable | None, info: ValidationInfo):
        if (
            thermal is not None
            and "rail" in info.data
            and info.data["rail"].material.expansion is None
        ):
            raise ValueError(
                'rails that expand: rail.material.expansion, for example "23.6e-6 1/K"'
            )
        return thermal

    @field_validator("output")
    @classmethod
    def _of_fitting_interval(cls, output: OutputTable, info: ValidationInfo):
        duration = info.data.get("duration")
        launch.require_samples(info.data, output)
        if duration is not None and not output.fits(duration):
            raise within(
                "interval",
                f"{output.interval:g} s",
                f"{duration / MOST_SAMPLES:g} s to {duration:g} s: at least one and at most "
                f"{MOST_SAMPLES:,} samples in "
                f"the duration of {duration:g} s",
            )
        return output

    @model_validator(mode="after")
    def _ends_beyond_a_pad(self):
        launch.require_way(self)
        return self

    def replace(self, overrides: Mapping[str, Any]) -> "Scene":
        """A new scene with dotted keys set.

        Changed values get the provenance "user", unless ``overrides`` has another under
        ``provenance.<key>``.

        Args:
            overrides: values by dotted key. Text carries units, a bare number is SI, None or "absent"
                drops a table.

        Returns:
            Scene: the new scene; this one stays as it is.

        Raises:
            SceneError: every fault, or a file that changed after this scene was read.

        Example:
            >>> scene = tipoff.load("tiny").replace({"payload.mass": "12 kg", "friction": None})
            >>> scene.payload.mass, scene.friction is None
            (12.0, True)
        """
        keys.require_shallow(overrides, f"override of {self._source}")
        raw = expansion.open_to(keys.plain(self._raw), overrides)
        lost = keys.apply_all(raw, overrides, Scene)
        provenance.mark(raw, overrides)
        scene, faults = _validated(raw, True)
        if any(key.split(".")[0] in _BESIDE for key in overrides):  # the others were valid before
            faults = faults + _beside_faults(raw, True, faults)
        if scene is None or lost or faults:
            raise SceneError(_reported(f"override of {self._source}", lost + faults))
        unchanged.require((self.thrust, self.rail), (scene.thrust, scene.rail), self._source)
        scene._raw, scene._source = raw, self._source
        return scene

    def condition(self, name: str) -> "Scene":
        """The scene of one named condition; "nominal" is the scene itself.

        Args:
            name: one of ``conditions``.

        Returns:
            Scene: the scene with the values of the condition.

        Raises:
            SceneError: a name that the scene does not have.

        Example:
            >>> tipoff.load("tiny").condition("phi15").thrust_offset is None
            False
        """
        is_text = isinstance(name, str)
        if is_text and name == NOMINAL:
            return self
        if not is_text or name not in self.conditions:
            known = ", ".join(self.conditions) or "none are defined"
            expected = f"one of {known}{close(str(name), self.conditions)}"
            raise SceneError([Fault(self._source, "conditions", repr(name), expected)])
        return self.replace(self.conditions[name])

    @property
    def warnings(self) -> list[str]:
        """Values that are allowed but implausible, by field name."""
        return plausibility.warnings(self)

    def __hash__(self) -> int:
        """For sets and dictionaries: equal scenes have equal physical inputs."""
        return hash(self.hash)

    def agrees(self) -> bool:
        """Whether valid tables fit each other: rails have an expansion if there is a temperature,
        the rail does not end behind every pad, the sampling interval fits the duration, and strokes
        end on the rail."""
        expands = self.thermal is None or self.rail.material.expansion is not None
        return expands and launch.fits(self)

    def absent_effects(self) -> list[str]:
        """Dotted keys of the effect tables that this scene does not have.

        Returns:
            list: keys such as ``gravity``.

        Example:
            >>> "gravity" in tipoff.load("tiny").absent_effects()
            True
        """
        return [effect.key for effect in EFFECTS if attrgetter(effect.key)(self) is None]


def parse(
    raw: Mapping[str, Any], source: str = "scene", bare_numbers_are_si: bool = False
) -> Scene:
    """The scene of the tables of a file, as ``tipoff.parse``, but without the number of the format."""
    keys.require_shallow(raw, source)
    tables = keys.without_absent(keys.plain(raw), Scene)
    if isinstance(tables, dict) and (wrong := pads.expand(tables)):
        raise SceneError(_reported(source, wrong))
    scene, faults = _validated(tables, bare_numbers_are_si)
    if isinstance(tables, dict):
        faults = faults + _beside_faults(tables, bare_numbers_are_si, faults)
    if scene is None or faults:
        raise SceneError(_reported(source, faults))
    scene._raw, scene._source = tables, source
    return scene


def load(name_or_path: str | Path) -> Scene:
    """Read a scene by its name in the catalogue or from a TOML file. Raises SceneError with every
    fault: file, key, given and expected.

    ``tipoff.load`` also warns of values that inherited conditions replace.
    """
    return parse(*reading.read(name_or_path))


def catalog() -> list[str]:
    """Names of the scenes that come with the package.

    Returns:
        list: names, sorted.

    Example:
        >>> "reference" in tipoff.catalog()
        True
    """
    return reading.names()


_Faults = list[tuple[str, str, str]]


def _validated(raw: Any, bare_numbers_are_si: bool) -> tuple[Scene | None, _Faults]:
    """The scene, or None with its faults as (key, given, expected). Converts conditions and
    provenance to dotted keys."""
    if isinstance(raw, dict):
        if isinstance(raw.get("provenance"), dict):
            raw["provenance"] = dict(keys.dotted(raw["provenance"]))
        for name, table in _tables(raw.get("conditions")):
            raw["conditions"][name] = dict(keys.dotted(table))
    found = expansion.expand(raw, bare_numbers_are_si)
    context = {"bare_numbers_are_si": bare_numbers_are_si}
    try:
        scene = Scene.model_validate(found.tables, context=context)
    except ValidationError as error:
        return None, found.with_faults([fault[1:] for fault in faults_of(error, "")])
    return (None if found.faults else scene), found.faults


def _reported(source: str, faults: _Faults) -> list[Fault]:
    """The faults, with the keys that were probably meant and with examples."""
    return [
        Fault(source, key, given, suggestions.expected(Scene, key, words))
        for key, given, words in faults
    ]


def _tables(raw: Any) -> list[tuple[str, dict]]:
    tables = raw if isinstance(raw, dict) else {}
    return [(name, table) for name, table in tables.items() if isinstance(table, dict)]


def _beside_faults(raw: dict, bare_numbers_are_si: bool, reported: _Faults) -> _Faults:
    """Faults in conditions, agreement and provenance, without ``reported`` ones, which are faults
    of the scene."""
    found = []
    for name, table in _tables(raw.get("conditions"))[:MOST]:  # more conditions are a fault
        varied = keys.plain({key: item for key, item in raw.items() if key not in _BESIDE})
        varied = expansion.open_to(varied, table)
        faults = keys.apply_all(varied, table, Scene) + _validated(varied, bare_numbers_are_si)[1]
        found += [
            (f"conditions.{name}.{key}", given, expected)
            for key, given, expected in faults
            if (key, given, expected) not in reported
        ]
    # A misspelt key that was set is already reported, so it is not reported again for its
    # provenance.
    return found + [
        fault
        for fault in roles.faults(raw, Scene)
        if not (reported and fault[1] == repr(provenance.USER))
    ]
