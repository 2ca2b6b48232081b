"""Sets up the cases of an ensemble: what a scene fixes once, what each row changes,
and groups of cases that one kernel call runs."""

import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from tipoff.lowfi import state, system
from tipoff.lowfi.contact import thermal_offset
from tipoff.lowfi.contact.compliant import record as wall_record
from tipoff.lowfi.dynamics import integrate, local_error, plan, settle
from tipoff.lowfi.numerics import Numerics, promises_of
from tipoff.lowfi.run import solved
from tipoff.mechanics import comoving, ending, outcome
from tipoff.mechanics import model as models
from tipoff.mechanics.model import Built
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.scenes.faults import SceneError
from tipoff.scenes.scene import Scene
from tipoff.scenes.variation import Variations


class Case(NamedTuple):
    """What an ensemble keeps of a run."""

    status: str
    message: str
    outcome: outcome.Outcome
    steps: int
    wall_s: float


class _Group(NamedTuple):
    """Records that all cases of a group share; ``rows`` are their numbers and overrides, ``cases``
    their models."""

    built: Built
    marks: outcome.Milestones
    plan: integrate.Plan
    rows: list[tuple[int, Mapping[str, Any]]]
    cases: list[models.Model]


class Family:
    """The cases of one scene. A row is run by the kernel of its group, or, where that leaves it
    open, by ``lowfi.run``."""

    def __init__(
        self,
        scene: Scene,
        calibration: Calibration | None,
        numerics: Numerics,
        compliance: RailCompliance | None = None,
    ):
        self.scene, self.calibration, self.numerics, self.compliance = (
            scene,
            calibration,
            numerics,
            compliance,
        )
        self.calibrated = calibration.apply(scene) if calibration else scene
        self.touched = (
            {key.partition(".")[0] for key in calibration.constants} if calibration else set()
        )
        self.variations = Variations(self.calibrated)
        self.base = models.built(self.calibrated)
        self.marks = outcome.milestones(self.calibrated, self.base.model)

    def jobs(
        self, table: Sequence[Mapping[str, Any]]
    ) -> list[Callable[[], list[tuple[int, Case]]]]:
        """Calls that run ``table``: each returns pairs of a row's number and its Case."""
        groups: dict[tuple, _Group] = {}
        alone: list[tuple[int, Mapping[str, Any] | Case]] = []
        for number, row in enumerate(table):
            if self.touched.intersection(key.partition(".")[0] for key in row):
                # A calibration is laid over what a row says of the same table, so the order counts.
                alone.append((number, row))
                continue
            try:
                built = models.built(self.variations.of(row), self.base)
                self._require_walls(built)
            except SceneError as error:
                alone.append((number, Case("refused", str(error), outcome.Outcome(), 0, 0.0)))
                continue
            group = self._group(groups, built)
            group.rows.append((number, row))
            group.cases.append(built.model)
        return [
            *(partial(self._settled, group) for group in groups.values()),
            *(partial(self._alone, number, item) for number, item in alone),
        ]

    def _require_walls(self, built: Built) -> None:
        scene, base = built.scene, self.base.scene
        if self.compliance is not None and not (
            scene.rail is base.rail and scene.pads is base.pads
        ):
            self.compliance.require(scene)
        if scene.thermal is not base.thermal:
            thermal_offset.require(scene, self.compliance)

    def _group(self, groups: dict, built: Built) -> _Group:
        scene, model = built.scene, built.model
        # The damping of rails that vibrate is no part of a model.
        key = (
            self._shared(built),
            scene.thrust.kind,
            scene.duration,
            scene.rail.damping and scene.rail.damping.record(),
        )
        if key not in groups:
            same = (
                scene.thrust is self.base.scene.thrust
                and scene.duration == self.base.scene.duration
            )
            marks = self.marks if same else outcome.milestones(scene, model)
            # The next row may be written over the tables of this one.
            kept = Built(scene.model_copy(deep=True), model, built.nominal)
            groups[key] = _Group(
                kept,
                marks._replace(jam_speed=outcome.jam_speed(model)),
                plan.make(model, scene.duration, self.numerics),
                [],
                [],
            )
        return groups[key]

    def _shared(self, built: Built) -> tuple:
        """By content, all that a model has but what ``_stacked`` takes from each case; None for
        what is the scene's own record."""

        def parts(of: Built) -> tuple:
            shared = of.model._asdict() | {
                "payload": None,
                "faces": None,
                "initial": None,
                "thrust_offset": of.model.thrust_offset is None,
            }
            return *shared.values(), of.nominal

        return tuple(
            None if part is own else (_content(part),)
            for part, own in zip(parts(built), parts(self.base))
        )

    def kernels(self, table: Sequence[Mapping[str, Any]]) -> list[Callable[[], np.ndarray]]:
        """Calls of the bare kernel for the groups of ``table``, set up beforehand: each returns
        ``settle``'s results. For timing."""
        groups: dict[tuple, _Group] = {}
        for number, row in enumerate(table):
            built = models.built(self.variations.of(row), self.base)
            group = self._group(groups, built)
            group.rows.append((number, row))
            group.cases.append(built.model)
        return [self._kernel(group) for group in groups.values()]

    def _kernel(self, group: _Group) -> Callable[[], np.ndarray]:
        model, planned, marks = group.built.model, group.plan, group.marks
        under_pads = wall_record.under_pads(
            group.built.scene, model, self.compliance, self.numerics.modes
        )
        under_law = thermal_offset.under_pads(group.built.scene, model, self.compliance)
        common, first = (
            system.build(model, compliance=under_pads, bow=under_law),
            plan.first_step(planned),
        )
        loop, cases = integrate.ready(common, state.initial(model), first), _stacked(common, group)
        results = np.zeros((len(group.cases), settle.RESULT_SIZE))
        allowed = local_error.tolerance(self.numerics, promises_of(self.numerics), 0.0)

        def call() -> np.ndarray:
            settle.settle(common, planned, (allowed, first), marks, cases, loop, results)
            return results

        return call

    def _settled(self, group: _Group) -> list[tuple[int, Case]]:
        began = clock.perf_counter()
        results = self._kernel(group)()
        share = (clock.perf_counter() - began) / len(results)
        return [
            (number, self._case(group, case, row, result, share))
            for (number, row), case, result in zip(group.rows, group.cases, results)
        ]

    def _alone(self, number: int, item: Mapping[str, Any] | Case) -> list[tuple[int, Case]]:
        return [(number, item if isinstance(item, Case) else self._whole(item))]

    def _case(
        self, group: _Group, model, row: Mapping[str, Any], result: np.ndarray, share: float
    ) -> Case:
        if result[settle.LEFT_OPEN]:
            return self._whole(row)
        status, found = ending.found(result[settle.BOOK :])
        return Case(
            status,
            "",
            comoving.outcome(comoving.frame(model), found),
            int(result[settle.TAKEN_STEPS]),
            share,
        )

    def _whole(self, row: Mapping[str, Any]) -> Case:
        try:
            found = solved(
                self.scene.replace(row), self.calibration, self.numerics, compliance=self.compliance
            )
        except SceneError as error:
            return Case("refused", str(error), outcome.Outcome(), 0, 0.0)
        return Case(
            found.status,
            found.message,
            found.outcome,
            int(found.cost["steps"]),
            found.cost["wall_s"],
        )


def _content(record: Any) -> Any:
    """What a record of records, arrays and numbers holds, to the last bit, as something to compare
    and to hash."""
    if record is None:
        return None
    if isinstance(record, tuple):
        return type(record), *(_content(part) for part in record)
    if isinstance(record, float):
        return record.hex()  # which tells the zeros apart
    values = np.asarray(record)
    return values.dtype.str, values.shape, values.tobytes()


def _stacked(common: system.System, group: _Group) -> settle.Cases:
    models_ = group.cases
    centre = np.stack([model.faces.centre for model in models_])
    faces = np.repeat(common.faces[None], len(models_), axis=0)
    faces[:, :, system.CENTRE : system.CENTRE + 3] = centre
    # all cases of a group have one, or none has
    offsets = [model.thrust_offset for model in models_ if model.thrust_offset is not None]
    return settle.Cases(
        np.array([model.payload.mass for model in models_]),
        np.stack([model.payload.inverse_inertia for model in models_]),
        faces,
        np.array([offset.direction for offset in offsets]) if offsets else None,
        np.array([offset.arm for offset in offsets]) if offsets else None,
        np.stack([state.initial(model) for model in models_]),
        np.sqrt((centre**2).sum(axis=2).max(axis=1)),
    )
