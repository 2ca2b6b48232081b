"""Stage ``ablation``: runs without each effect, one at a time, in both fidelities: change of rates
and time, and the effects whose laws are evaluated.

The baseline has all effects: effects that the scene lacks are added with the small values in ``ADDED``,
except effects that need values of the scene (contact, friction, platform, and temperature for a material
without expansion). The last lines are the scene itself and the scene without any effect. The reference
has one more line: the baseline with all rails stepped, also at rest. The surrogate runs all variants in
turn, so other load on the machine affects all of them alike.
"""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np

from tipoff.faults import SceneError
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import settled
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.scene import Scene
from tipoff.studies.render.column import Column
from tipoff.workspace import machine
from tipoff.workspace.compiling import compile_ahead, warm_up
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study
from tipoff.workspace.timing import timed

Rates = tuple[float, float, float]
EVERYTHING = "all effects, every rail stepped"
ADDED = {effect.key: effect.example for effect in EFFECTS if effect.example}


@dataclass(frozen=True)
class VariantRun:
    """One variant in one model."""

    fidelity: Annotated[str, Column("model")]
    variant: Annotated[str, Column("variant")]
    status: Annotated[str, Column("status")]
    time_s: Annotated[float, Column("time", "s")]
    time_ratio: Annotated[float, Column("time ratio", form=".2f")]  # to that with all effects
    ns_per_step: Annotated[float, Column("time per step", "ns", ",.0f", detail=True)]
    settled_rate_deg_s: Annotated[Rates | None, Column("settled x, y, z", "deg/s", detail=True)]
    settled_rate_change_deg_s: Annotated[Rates | None, Column("change x, y, z", "deg/s", "+.3g")]
    evaluated: Annotated[tuple[str, ...], Column("effects evaluated", nothing="none", detail=True)]


@dataclass(frozen=True)
class Ablation:
    """``rows`` of a ``condition``, with ``element_size_m`` of the reference; ``added``: overrides
    by the effect that the scene lacks."""

    condition: str
    added: dict[str, dict]
    element_size_m: float
    rows: tuple[VariantRun, ...]
    hardware: dict


def variants(scene: Scene) -> dict[str, dict]:
    """Overrides of ``scene`` for each line of the table, by name."""
    absent = scene.absent_effects()
    added = {
        effect: values
        for effect, values in ADDED.items()
        if effect != "thermal" or scene.rail.material.expansion is not None
    }
    everything = {key: value for effect in absent for key, value in added.get(effect, {}).items()}
    present = [effect.key for effect in EFFECTS if effect.key not in absent or effect.key in added]
    lines = {"all effects": everything}
    for effect in present:
        kept = {key: value for key, value in everything.items() if not key.startswith(f"{effect}.")}
        lines |= _without(scene, effect, kept | {effect: None})
    return lines | {"as the scene asks": {}, "no effect": dict.fromkeys(present)}


def _without(scene: Scene, effect: str, changes: dict) -> dict[str, dict]:
    """The line of ``scene`` with ``changes`` that leave out an ``effect``. A payload that cannot rest on
    its rails without it starts at its nominal place, and the line says so."""
    line = f"without {effect}"
    if effect != "initial" and settled.is_settled(scene):
        try:
            settled.require(scene.replace(changes))
        except SceneError:
            return {f"{line}, not settled": changes | {"initial.settled": False}}
    return {line: changes}


def run(study: Study) -> Made[Ablation]:
    """Rates and times without each effect, on the first refined condition, or else on the first condition."""
    name = (study.scene.agreement.refined or tuple(study.conditions))[0]

    def make() -> tuple[Ablation, list[Path]]:
        lines = variants(study.condition(name))
        stepped = lines | {EVERYTHING: lines["all effects"]}
        reference = [
            study.coarse(name, changes, _tag(line), step_everything=line == EVERYTHING)
            for line, changes in stepped.items()
        ]
        surrogate = surrogate_runs(study, name, lines)
        compile_ahead("ablation, kernels", reference + surrogate, study.settings.workers)
        rows = _rows("highfi", stepped, reference, *_timed_reference(study, reference)) + _rows(
            "lowfi", lines, surrogate, *timed_surrogate(study, surrogate)
        )
        size = study.settings.coarse_size
        return Ablation(name, ADDED, size, tuple(rows), machine.describe()), []

    return STAGE.run(study, None, make)


STAGE = Stage("ablation", __name__, result=Ablation)


def surrogate_runs(study: Study, name: str, lines: dict[str, dict]) -> list[Run]:
    """A run of the surrogate for each line, on the compliance of its rails if it has contact. All
    runs have no rail modes, because a number chosen for each line would be another change."""
    scenes = {line: study.condition(name).replace(changes) for line, changes in lines.items()}
    under = study.compliances_of(scenes)
    return [
        study.lowfi(
            name,
            None,
            lines[line],
            _tag(line),
            under[line],
            modes=0,
        )
        for line in scenes
    ]


def _timed_reference(study: Study, runs: list[Run]) -> tuple[list[Trajectory], list[float]]:
    """The results, and the processor time (s) of the thread of each run, which parallel runs do not
    change."""
    found = study.store.fill("ablation, highfi", runs)
    return found, [run.cost.get("cpu_s", run.cost["wall_s"]) for run in found]


def timed_surrogate(study: Study, runs: list[Run]) -> tuple[list[Trajectory], list[float]]:
    """The results of runs in turn, and the median time (s) of their time loops. Set-up and
    evaluation are left out, because they are the same for all."""
    for run in runs:
        warm_up(run)
    rounds = [[timed(run) for run in runs] for _ in range(study.settings.lowfi_repeats)]
    times = [
        statistics.median(run.cost["kernel_s"] for run, _, _ in repeats) for repeats in zip(*rounds)
    ]
    return [run for run, _, _ in rounds[0]], times


def _rows(
    fidelity: str,
    lines: dict[str, dict],
    requested: list[Run],
    runs: list[Trajectory],
    times: list[float],
) -> list[VariantRun]:
    baseline = runs[0].outcome.rate
    return [
        VariantRun(
            fidelity=fidelity,
            variant=line,
            status=run.status,
            time_s=seconds,
            time_ratio=seconds / times[0],
            ns_per_step=1e9 * seconds / max(run.cost["steps"], 1),
            settled_rate_deg_s=_degrees(run.outcome.rate),
            settled_rate_change_deg_s=_change(run.outcome.rate, baseline),
            evaluated=tuple(evaluated(item, run)),
        )
        for line, item, run, seconds in zip(lines, requested, runs, times)
    ]


def _degrees(rate: Sequence[float] | None) -> Rates | None:
    return None if rate is None else tuple(np.degrees(rate).tolist())


def _change(rate: Sequence[float] | None, baseline: Sequence[float] | None) -> Rates | None:
    if rate is None or baseline is None:
        return None
    return _degrees([own - other for own, other in zip(rate, baseline)])


def evaluated(run: Run, result: Trajectory) -> list[str]:
    """Effects whose laws ``run``, which has this ``result``, evaluates."""
    if run.fidelity == "highfi":
        found = result.cost["evaluations"]
    else:
        from tipoff import lowfi

        found = lowfi.evaluations(run.scene, run.numerics, run.compliance)
    return sorted(effect for effect, times in found.items() if times)


def _tag(line: str) -> str:
    return "-" + line.replace(" ", "-")
