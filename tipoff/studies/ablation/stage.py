"""Stage ``ablation``: runs without each effect, one at a time, in both fidelities: change of rates
and time, and the effects in each compiled kernel.

The baseline has all effects: those that the scene lacks are added with the small values in
``ADDED``, except those that need values of the scene (contact, friction, platform, and temperature
for a material without expansion). The last lines are the scene itself and the scene without any
effect; the reference has one more, the baseline with the rails that rest stepped too. The surrogate
runs all variants in turn, so that other load on the machine affects all of them alike.
"""

import importlib
import statistics
from pathlib import Path

import numpy as np

from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.effects.registry import EFFECTS
from tipoff.scenes.scene import Scene
from tipoff.workspace import machine
from tipoff.workspace.compiling import compile_ahead, warm_up
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study
from tipoff.workspace.timing import timed

EVERYTHING = "all effects, every rail stepped"
ADDED = {effect.key: effect.example for effect in EFFECTS if effect.example}


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
        lines[f"without {effect}"] = kept | {effect: None}
    return lines | {"as the scene asks": {}, "no effect": dict.fromkeys(present)}


def run(study: Study) -> dict:
    """``rows``: for each fidelity and variant the processor time (s) and its ratio, the settled
    rates and their change (deg/s), the effects in the compiled kernel."""
    name = (study.scene.agreement.refined or tuple(study.conditions))[0]

    def make() -> tuple[dict, list[Path]]:
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
        return {
            "condition": name,
            "added": ADDED,
            "element_size_m": study.settings.coarse_size,
            "rows": rows,
            "hardware": machine.describe(),
        }, []

    return study.stage("ablation", study.key(__name__, name, ADDED), make)


def surrogate_runs(study: Study, name: str, lines: dict[str, dict]) -> list[Run]:
    """A run of the surrogate for each line: on the compliance of its rails, unless there is no
    contact. No rail has inertia: a number of modes chosen for each line would be one more change."""
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
    """The results, and the processor time (s) of the thread of each, which parallel runs do not
    change."""
    found = study.store.fill("ablation, highfi", runs)
    return found, [run.cost.get("cpu_s", run.cost["wall_s"]) for run in found]


def timed_surrogate(study: Study, runs: list[Run]) -> tuple[list[Trajectory], list[float]]:
    """The results of runs in turn, and the median time (s) of their time loops, without set-up and
    evaluation, which are the same for all."""
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
) -> list[dict]:
    rows = []
    for line, item, run, seconds in zip(lines, requested, runs, times):
        rate, baseline = run.outcome.rate, runs[0].outcome.rate
        change = (
            None
            if rate is None or baseline is None
            else np.degrees(np.subtract(rate, baseline)).tolist()
        )
        rows.append(
            {
                "fidelity": fidelity,
                "variant": line,
                "status": run.status,
                "time_s": seconds,
                "ns_per_step": 1e9 * seconds / max(run.cost["steps"], 1),
                "time_ratio": seconds / times[0],
                "settled_rate_deg_s": None if rate is None else np.degrees(rate).tolist(),
                "settled_rate_change_deg_s": change,
                "compiled": compiled(item),
            }
        )
    return rows


def compiled(run: Run) -> list[str]:
    """Effects with code in the kernel compiled for ``run``."""
    arguments = {"compliance": run.compliance} if run.compliance is not None else {}
    present = importlib.import_module(f"tipoff.{run.fidelity}").compiled_effects(
        run.scene, run.numerics, **arguments
    )
    return sorted(effect for effect in present if present[effect])


def _tag(line: str) -> str:
    return "-" + line.replace(" ", "-")
