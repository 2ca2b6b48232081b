"""Cases of an ensemble, in groups for one kernel call each."""

import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from tipoff.faults import SceneError
from tipoff.lowfi.dynamics import cases, integrate
from tipoff.lowfi.dynamics.loop import Sampling
from tipoff.lowfi.dynamics.sample import SAMPLE_SIZE
from tipoff.lowfi.models import require_walls
from tipoff.lowfi.numerics import AUTO, Numerics, promises_of
from tipoff.lowfi.preparation import prepare
from tipoff.lowfi.simulation import solved
from tipoff.mechanics import books, comoving, outcome
from tipoff.mechanics.laws.friction import Friction
from tipoff.mechanics.laws.hold_down import HoldDown
from tipoff.mechanics.laws.sticking import Sticking
from tipoff.mechanics.model import Faces, Model
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes import changes, launch, rail_compliance, scene_model
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.scene import Scene
from tipoff.scenes.scene_model import Built
from tipoff.scenes.variation import Variations

_NONE = np.zeros(0)


class Case(NamedTuple):
    """Result of one case."""

    status: str
    message: str
    outcome: outcome.Outcome
    steps: int
    wall_s: float  # s


class _Group(NamedTuple):
    """Cases that share all records except those of ``cases.Cases``."""

    scene: Scene
    marks: outcome.Milestones
    rows: list[tuple[int, Mapping[str, Any]]]  # number and overrides of each case
    models: list[Model]  # of each case


class Family:
    """The cases of one scene, with every clearance increased by ``widening`` (m). The kernel of its
    group runs a case; ``lowfi.run`` runs cases that the kernel leaves open. All have the modes of
    the ``numerics``. Raises ValueError if the rails may vibrate and no number of modes is
    chosen."""

    def __init__(
        self,
        scene: Scene,
        calibration: Calibration | None,
        numerics: Numerics,
        compliance: RailCompliance | None = None,
        widening: float = 0.0,
    ):
        if numerics.modes == AUTO and rail_compliance.may_vibrate(scene, compliance):
            raise ValueError("modes: cases of an ensemble need a number, which its pilot chooses")
        if numerics.degree == AUTO:
            raise ValueError("degree: cases of an ensemble need a number")
        self.scene, self.calibration, self.widening = scene, calibration, widening
        self.numerics, self.compliance = numerics, compliance
        calibrated = calibration.apply(scene) if calibration else scene
        constants = calibration.constants if calibration else {}
        self.calibrated_tables = {key.partition(".")[0] for key in constants}
        self.variations = Variations(calibrated)
        self.changes = calibration.changes if calibration else {}
        self.stated = Variations(scene) if self.changes else None
        self.base = scene_model.built(calibrated)
        self.base_parts = _parts(self.base)
        self.burnouts = outcome.burnouts(launch.of_scene(calibrated), calibrated.time_limit)

    def jobs(
        self, table: Sequence[Mapping[str, Any]]
    ) -> list[Callable[[], list[tuple[int, Case]]]]:
        """Calls that run ``table``; each returns pairs of a row's number and its Case."""
        groups, alone = self._grouped(table)
        return [
            *(partial(self._run_group, group) for group in groups),
            *(partial(self._run_alone, number, item) for number, item in alone),
        ]

    def kernels(self, table: Sequence[Mapping[str, Any]]) -> list[Callable[[], np.ndarray]]:
        """Calls of the kernel only for the groups of ``table``, set up in advance; each returns the
        results of ``lowfi.dynamics.cases``. For timing."""
        return [self._kernel(group) for group in self._grouped(table)[0]]

    def _grouped(
        self, table: Sequence[Mapping[str, Any]]
    ) -> tuple[list[_Group], list[tuple[int, Mapping[str, Any] | Case]]]:
        """Groups of ``table``, and rows without a group, by number: overrides to run alone, or the
        Case of a refused row."""
        groups: dict[tuple, _Group] = {}
        alone: list[tuple[int, Mapping[str, Any] | Case]] = []
        for number, row in enumerate(table):
            if self.calibrated_tables.intersection(key.partition(".")[0] for key in row):
                # A calibration replaces values of a row in the same table, so the order matters.
                alone.append((number, row))
                continue
            try:
                built = scene_model.built(self._scene(row), self.base)
                self._require_compliance(built)
            except SceneError as error:
                alone.append((number, _refused(error)))
                continue
            if built.model.initial.settled:  # each case needs statics of its own
                alone.append((number, row))
                continue
            group = self._group(groups, built)
            group.rows.append((number, row))
            group.models.append(built.model)
        return list(groups.values()), alone

    def _scene(self, row: Mapping[str, Any]) -> Scene:
        """The scene of a case; it is overwritten by the next one."""
        changed = self._changed(row)
        scene = self.variations.of(changed)
        if not self.widening or scene.contact is None:
            return scene
        return self.variations.of({**changed, **scene.contact.widened(self.widening)})

    def _changed(self, row: Mapping[str, Any]) -> Mapping[str, Any]:
        """The overrides of a row, plus the changes of the calibration to the values that it
        states."""
        if self.stated is None:
            return row
        return {**row, **changes.overrides(self.stated.of(row), self.changes)}

    def _require_compliance(self, built: Built) -> None:
        scene, base = built.scene, self.base.scene
        changed = any(
            getattr(scene, name) is not getattr(base, name) for name in ("rail", "pads", "thermal")
        )
        if changed and scene.contact is not None:
            require_walls(scene, self.compliance)
            if self.compliance is not None:
                rail_compliance.require(self.compliance, scene)

    def _group(self, groups: dict, built: Built) -> _Group:
        scene, limit, marks = built.scene, built.scene.time_limit, self._marks(built)
        # The damping of vibrating rails and the stiffness of mounts are not part of a model.
        key = (
            self._shared(built),
            scene.thrust.kind,
            limit,
            marks,
            scene.rail.damping and scene.rail.damping.record(),
            scene.rail.joint(),
        )
        if key not in groups:
            # The next row may overwrite the tables of this one.
            groups[key] = _Group(self.variations.kept(scene), marks, [], [])
        return groups[key]

    def _marks(self, built: Built) -> outcome.Milestones:
        scene, base = built.scene, self.base.scene
        same = scene.thrust is base.thrust and scene.time_limit == base.time_limit
        return outcome.milestones(
            launch.of_scene(scene), scene.time_limit, self.burnouts if same else None
        )

    def _shared(self, built: Built) -> tuple:
        """Content of all records of a model that ``cases.Cases`` does not take from each case; None
        for records of the scene."""
        return tuple(
            None if part is own else (_content(_without_own(part)),)
            for part, own in zip(_parts(built), self.base_parts)
        )

    def _kernel(self, group: _Group) -> Callable[[], np.ndarray]:
        prepared = prepare(
            group.scene,
            group.models,
            group.marks,
            self.numerics,
            promises_of(self.numerics),
            self.compliance,
        )
        nothing = Sampling(
            interval=0.0,
            last=-1,
            number=-1,
            whole=False,
            rows=np.zeros((0, SAMPLE_SIZE)),
            forces=np.zeros((0, len(prepared.system.faces), 3)),
            loads=books.no_loads(0),
        )

        def call() -> np.ndarray:
            integrate.integrate(*prepared, nothing)
            return prepared.cases.results

        return call

    def _run_group(self, group: _Group) -> list[tuple[int, Case]]:
        began = clock.perf_counter()
        results = self._kernel(group)()
        share = (clock.perf_counter() - began) / len(results)
        return [
            (number, self._case(model, row, result, share))
            for (number, row), model, result in zip(group.rows, group.models, results)
        ]

    def _run_alone(self, number: int, item: Mapping[str, Any] | Case) -> list[tuple[int, Case]]:
        return [(number, item if isinstance(item, Case) else self._run_whole(item))]

    def _case(self, model: Model, row: Mapping[str, Any], result: np.ndarray, share: float) -> Case:
        if result[cases.LEFT_OPEN]:
            return self._run_whole(row)
        status, found = books.found(result[cases.BOOK :])
        return Case(
            status,
            "",
            comoving.outcome(comoving.frame(model), outcome.with_impulse(found, model)),
            int(result[cases.STEPS]),
            share,
        )

    def _run_whole(self, row: Mapping[str, Any]) -> Case:
        try:
            scene, calibration = self.scene.replace(row), self.calibration
            if self.widening:
                # a calibration may replace the clearance of a row, so it comes first
                scene, calibration = calibration.apply(scene) if calibration else scene, None
                if scene.contact is not None:
                    scene = scene.replace(scene.contact.widened(self.widening))
            found = solved(scene, calibration, self.numerics, compliance=self.compliance)
        except SceneError as error:
            return _refused(error)
        return Case(
            found.status,
            found.message,
            found.outcome,
            int(found.cost["steps"]),
            found.cost["wall_s"],
        )


def _refused(error: SceneError) -> Case:
    return Case("refused", str(error), outcome.Outcome(), 0, 0.0)


def _parts(of: Built) -> tuple:
    """The records of a model without those that each case has of its own."""
    own = {"payload": None, "faces": None, "initial": None}
    shared = of.model._asdict() | own | {"thrust_offset": of.model.thrust_offset is None}
    return *shared.values(), of.nominal


def _without_own(record: Any) -> Any:
    """A record of a model without the numbers that each case has of its own."""
    if isinstance(record, Faces):
        return record._replace(wall=_NONE)
    if isinstance(record, Friction | Sticking):
        return record._replace(static=0.0, dynamic=0.0)
    if isinstance(record, HoldDown) and record.is_stop:
        return record._replace(release=0.0)
    return record


def _content(record: Any) -> Any:
    """Values of nested records, arrays and numbers, to the last bit, in a form for comparison and
    hashing."""
    if record is None:
        return None
    if isinstance(record, tuple):
        return type(record), *(_content(part) for part in record)
    if isinstance(record, float):
        return record.hex()  # distinguishes 0.0 and -0.0
    values = np.asarray(record)
    return values.dtype.str, values.shape, values.tobytes()
