"""``[thrust] kind = "spring"`` and ``"springs"``: spring pushers, whose force depends on travel.

Each pusher has a preload, a rate and a stroke, or a table of force over travel from a CSV file, and
a constant friction. Its law is in ``mechanics.laws.pushers``. It ends when its stroke is used up, and it reacts
on the platform.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    ValidationInfo,
    field_validator,
    model_validator,
)

from tipoff.formats.push_table import Push, read_push
from tipoff.mechanics.laws.pushers import Pushers
from tipoff.mechanics.laws.thrust import Thrust
from tipoff.scenes.effects.thrust_offset import Misalignment
from tipoff.scenes.faults import within
from tipoff.scenes.rounding import apart, below
from tipoff.scenes.table import Table, at_least_one, is_absent, is_one, is_zero, limited
from tipoff.scenes.units import (
    Length,
    NonNegativeMass,
    PositiveForce,
    PositiveLength,
    PositiveNumber,
    PushFriction,
    SpringRate,
)


class Spring(Table):
    """One spring pusher: ``preload`` (N), ``rate`` (N/m) and ``stroke`` (m), or a table."""

    #: Force at zero travel; with rate and stroke, or a file instead of all three.
    preload: PositiveForce | None = None
    #: Loss of force per travel.
    rate: SpringRate | None = None
    #: Travel at which the pusher reaches its stop.
    stroke: PositiveLength | None = None
    #: CSV file with the columns travel and force and their units, as in "travel [mm],force [N]";
    #: relative to the scene file.
    file: str | None = None
    #: Multiplies the force of preload and rate, or of the file; studies of uncertainty vary it.
    factor: PositiveNumber = Field(1.0, exclude_if=is_one)
    #: Constant friction of the pusher, against its motion.
    friction: PushFriction = 0.0
    #: Mass of the part of the pusher that goes with the payload, up to the end of the stroke.
    mass: NonNegativeMass = Field(0.0, exclude_if=is_zero)
    # of the knots, as numbers, so that tables can be compared
    _points: tuple[tuple[float, ...], tuple[float, ...]] = PrivateAttr()

    @field_validator("stroke")
    @classmethod
    def _pushes_to_its_end(cls, stroke: float | None, info: ValidationInfo):
        preload, rate = info.data.get("preload"), info.data.get("rate")
        if preload is None or rate is None or stroke is None:
            return stroke
        last = preload - rate * stroke
        if below(last, 0.0, preload):
            raise ValueError(
                f"at most {preload / rate:.6g} m: there the force is {last:.4g} N, and a pusher does "
                "not pull"
            )
        return stroke

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str | None):
        if file is not None:
            read_push(file)
        return file

    @field_validator("friction")
    @classmethod
    def _starts(cls, friction: float, info: ValidationInfo):
        preload, file = info.data.get("preload"), info.data.get("file")
        first = preload if file is None else float(read_push(file).force[0])
        first = None if first is None else info.data.get("factor", 1.0) * first
        if first is not None and friction > 0.0 and friction >= first:
            raise ValueError(
                f"less than the force of {first:g} N at zero travel, or nothing starts"
            )
        return friction

    @model_validator(mode="after")
    def _complete(self):
        numbers = {"preload": self.preload, "rate": self.rate, "stroke": self.stroke}
        given = [name for name, value in numbers.items() if value is not None]
        if self.file is None and len(given) < len(numbers):
            missing = next(name for name in numbers if name not in given)
            raise within(missing, "nothing", "preload, rate and stroke, or a file instead")
        if self.file is not None and given:
            raise within("file", f"a file and {', '.join(given)}", "one or the other")
        made = self._made()
        self._points = tuple(made.travel.tolist()), tuple(made.force.tolist())
        least = float(made.force.min())
        if below(least, self.friction):
            given, most = apart(self.friction, least)
            raise within(
                "friction",
                f"{given} N",
                f"at most {most} N, the least force within the stroke, where the pusher would "
                "stop; or a shorter stroke",
            )
        return self

    def _made(self) -> Push:
        travel, force = self._stated()
        return Push(travel, self.factor * force)

    def _stated(self) -> Push:
        """Force over travel without the factor."""
        if self.file is not None:
            return read_push(self.file)
        assert self.preload is not None and self.rate is not None and self.stroke is not None
        last = max(self.preload - self.rate * self.stroke, 0.0)
        return Push(np.array([0.0, self.stroke]), np.array([self.preload, last]))

    def push(self) -> Push:
        """Force over travel."""
        return Push(*map(np.array, self._points))


class PlacedSpring(Spring):
    """One of several spring pushers."""

    #: Place of its line of action along Y.
    y: Length = 0.0
    #: Place of its line of action along Z.
    z: Length = 0.0
    #: Error of its direction.
    misalignment: Misalignment | None = Field(None, exclude_if=is_absent)


class PushedTable(Table):
    """Keys of both kinds."""

    #: Distance of the points of application behind the nominal mass centre.
    arm: PositiveLength = 0.1
    #: The reaction acts on the platform.
    reaction: Literal["platform"] = "platform"
    if TYPE_CHECKING:
        kind: str  # a literal in each kind, at the place of its key

    def places(self) -> list[tuple[Spring, float, float]]:
        """The springs with the places (m) of their lines along Y and Z."""
        raise NotImplementedError

    def tilts(self) -> list[tuple[float, float, float]]:
        """Unit vectors of the springs, without the misalignment of the thrust."""
        return [(1.0, 0.0, 0.0)] * len(self.places())

    def pushes(self) -> list[tuple[Push, float]]:
        """Force over travel and friction (N) of each spring."""
        return [(spring.push(), spring.friction) for spring, _, _ in self.places()]

    def record(self) -> Thrust:
        """Kernel record of the thrust over time, which is absent."""
        return Thrust(pulses=None, curve=None)

    def peak(self) -> float:
        """Largest sum of all forces (N) at equal travel."""
        knots = np.unique(np.concatenate([push.travel for push, _ in self.pushes()]))
        total = np.zeros(knots.size)
        for push, _ in self.pushes():
            total += np.interp(knots, push.travel, push.force, right=0.0)
        return float(total.max())

    def middle(self) -> tuple[float, float]:
        """Mean place (m) of the lines of action along Y and Z, weighted with their energy."""
        weights = [float(push.energy()[-1]) for push, _ in self.pushes()]
        _, y, z = zip(*self.places())
        return float(np.dot(weights, y) / sum(weights)), float(np.dot(weights, z) / sum(weights))

    def energy(self) -> float:
        """Energy (J) of all springs over their strokes."""
        return float(sum(push.energy()[-1] for push, _ in self.pushes()))

    def friction_loss(self) -> float:
        """Loss (J) by the friction of all pushers over their strokes."""
        return float(sum(held * push.travel[-1] for push, held in self.pushes()))

    def describe(self, duration: float) -> dict[str, float | str]:
        """The thrust for results and report: numbers in SI by name, and a sentence, ``text``. They
        do not depend on ``duration``."""
        return {
            "kind": self.kind,
            "peak_N": self.peak(),
            "energy_J": self.energy(),
            "friction_J": self.friction_loss(),
            "stroke_m": self.longest(),
            "text": self.words(),
        }

    def longest(self) -> float:
        """The longest stroke (m)."""
        return max(float(push.travel[-1]) for push, _ in self.pushes())

    def words(self) -> str:
        """The springs in words."""
        count = len(self.pushes())
        return (
            f"{self.kind}{f', {count} of them' if count > 1 else ''}, {self.peak():.4g} N at most, "
            f"energy {self.energy():.7g} J over a stroke of {1e3 * self.longest():.6g} mm, of which "
            f"friction of the pusher takes {self.friction_loss():.7g} J{self._moving()}"
        )

    def _moving(self) -> str:
        mass = sum(spring.mass for spring, *_ in self.places())
        return f"; {mass:.4g} kg go with the payload to the end of the stroke" if mass else ""

    def contents(self) -> tuple[dict, list[list[float]]]:
        """The table without paths, and the points of its files, for the hash of a scene."""
        found = self.model_dump(mode="json", exclude_none=True)
        for table in found.get("springs", [found]):
            table.pop("file", None)
        return found, [part.tolist() for _, _, push in self.files() for part in push]

    def files(self) -> Iterator[tuple[str, str, Push]]:
        """Key, path and content of each file."""
        for key, spring in self.named():
            if spring.file is not None:
                yield f"{key}file", spring.file, spring.push()

    def named(self) -> Iterator[tuple[str, Spring]]:
        """The springs, with the beginning of their keys in ``[thrust]``."""
        raise NotImplementedError


class SpringTable(Spring, PushedTable):
    """``[thrust] kind = "spring"``: the keys of one spring, whose line is that of the thrust."""

    #: One spring pusher.
    kind: Literal["spring"]

    def places(self) -> list[tuple[Spring, float, float]]:
        """The only spring, which is the table itself."""
        return [(self, 0.0, 0.0)]

    def named(self) -> Iterator[tuple[str, Spring]]:
        """The only spring."""
        yield "", self


class SpringsTable(PushedTable):
    """``[thrust] kind = "springs"`` with ``[[thrust.springs]]``, one pusher each."""

    #: Several spring pushers beside each other.
    kind: Literal["springs"]
    #: The pushers.
    springs: Annotated[tuple[PlacedSpring, ...], limited, AfterValidator(at_least_one)]

    def places(self) -> list[tuple[Spring, float, float]]:
        """The springs."""
        return [(spring, spring.y, spring.z) for spring in self.springs]

    def tilts(self) -> list[tuple[float, float, float]]:
        """Unit vectors of the springs."""
        return [
            (1.0, 0.0, 0.0) if spring.misalignment is None else spring.misalignment.direction()
            for spring in self.springs
        ]

    def named(self) -> Iterator[tuple[str, Spring]]:
        """The springs."""
        for number, spring in enumerate(self.springs):
            yield f"springs.{number}.", spring


def record(thrust, thrust_offset, mass_offset, platform) -> Pushers | None:
    """Kernel record of the pushers of ``[thrust]``, None for a thrust over time. ``thrust_offset``
    and ``mass_offset`` are tables or None, ``platform`` is a kernel record or None."""
    if not isinstance(thrust, PushedTable):
        return None
    direction, line = np.array(thrust.tilts()), (0.0, 0.0, 0.0)
    if thrust_offset is not None:
        direction = direction @ _turned(thrust_offset.misalignment.direction())
        line = thrust_offset.eccentricity.offset()
    centre = np.array(mass_offset.eccentricity.offset() if mass_offset else (0.0, 0.0, 0.0))
    place = np.array([(-thrust.arm, line[1] + y, line[2] + z) for _, y, z in thrust.places()])
    base = np.array(platform.mass_centre if platform else (0.0, 0.0, 0.0))
    pushes = [push for push, _ in thrust.pushes()]
    mass = np.array([spring.mass for spring, *_ in thrust.places()])
    return Pushers(
        direction=direction,
        point=place - centre,
        origin=((place - base) * direction).sum(axis=1),
        first=np.cumsum([0, *(push.travel.size for push in pushes)]),
        travel=np.concatenate([push.travel for push in pushes]),
        force=np.concatenate([push.force for push in pushes]),
        energy=np.concatenate([push.energy() for push in pushes]),
        friction=np.array([held for _, held in thrust.pushes()]),
        mass=mass if mass.any() else np.zeros(0),
    )


def _turned(thrust: tuple[float, float, float]) -> np.ndarray:
    """The shortest rotation of the X axis to the unit vector ``thrust``, (3,3), for rows."""
    x, y, z = thrust
    if x == 1.0:
        return np.eye(3)
    axis = np.array([[0.0, y, z], [-y, 0.0, 0.0], [-z, 0.0, 0.0]])
    return np.eye(3) + axis + axis @ axis / (1.0 + x)
