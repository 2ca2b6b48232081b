"""Growth of the run time with the elements of the reference, with the pads of each model, and with
the active effects.

    t = c n^p,   p the slope of a straight line through log t over log n, with its standard error

Elements: the work of a step is proportional to n elements, so p = 1 per step. The step limit is
proportional to the edge of an element, so a run has n^(1/3) times as many steps: p = 4/3. Smaller values
occur on coarse meshes, for two reasons: a part of a step takes the same time on any mesh (a of t = a + b
n), and the thickness of a wall, one element, limits the step.

Pads are removed, or added between the others of the same payload. This changes the motion and its
contacts, so p of a run includes that change; p of a step has less of it. The runs have no rail modes,
because a number chosen for each would be another change. Effects differ in kind, so
only the time of each, and of all over none, is given.

Times are of one processor, without compilation, as in the ablation study: of a whole run of the
reference, of the time loop of the surrogate.
"""

import statistics
from collections.abc import Sequence
from typing import Any

import numpy as np

from tipoff.faults import SceneError
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.results.trajectory import Trajectory
from tipoff.scenes.rail import MeshTable
from tipoff.scenes.scene import Scene
from tipoff.studies.ablation.stage import Ablation
from tipoff.workspace.compiling import warm_up
from tipoff.workspace.progress import Board
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study
from tipoff.workspace.timing import timed
from validation.bench import done
from validation.scaling.results import (
    EffectTime,
    EffectTimes,
    Growth,
    Laws,
    MeshGrowth,
    PowerLaw,
    Rung,
    Timing,
)

_TIME = {"highfi": "cpu_s", "lowfi": "kernel_s"}
_SHARES = (0.125, 0.25, 0.5, 1.0, 2.0)  # of the scene's own number of pads
_REPEATS = {"highfi": 2, "lowfi": 20}


def power_law(sizes: Sequence[float], times: Sequence[float]) -> PowerLaw:
    """The law of ``times`` (s) over ``sizes``; a mesh from a file has a single size."""
    if len(set(sizes)) < 2:
        return PowerLaw(None, None)
    from scipy.stats import linregress  # slow to load

    line = linregress(np.log(sizes), np.log(times))
    return PowerLaw(float(line.slope), float(line.stderr) if len(sizes) > 2 else None)


def shares(
    sizes: Sequence[float], times: Sequence[float]
) -> tuple[float, float] | tuple[None, None]:
    """a and b of t = a + b n, by least squares of the relative error; None for a single size."""
    if len(set(sizes)) < 2:
        return None, None
    design = np.column_stack([1.0 / np.array(times), np.array(sizes) / np.array(times)])
    fixed, each = np.linalg.lstsq(design, np.ones(len(times)))[0]
    return float(fixed), float(each)


def fitted(model: str, points: Sequence[Timing]) -> Growth:
    """The ``points`` of one model with their power laws."""
    sizes = [point.n for point in points]
    return Growth(
        model=model,
        points=tuple(points),
        run=power_law(sizes, [point.time_s for point in points]),
        step=power_law(sizes, [point.step_s for point in points]),
    )


def elements(study: Study, name: str) -> MeshGrowth:
    """Growth over the meshes of the reference. The runs are those of other stages, medians over
    conditions."""
    names = dict.fromkeys([name, *study.scene.agreement.fitted])
    coarsest = 2.0 * study.settings.coarse_size
    wanted = {
        coarsest: [study.highfi(name, element_size=coarsest, tag="-coarsest")],
        study.settings.coarse_size: [study.coarse(each) for each in names],
        study.settings.element_size: [study.highfi(each) for each in names],
    }
    runs = iter(
        study.store.fill("growth, elements", [run for group in wanted.values() for run in group])
    )
    points = [
        _median([next(runs) for _ in group], "cpu_s", element_size_m=size)
        for size, group in wanted.items()
    ]
    law, finest = fitted(FINITE_ELEMENTS, points), fitted(FINITE_ELEMENTS, points[-2:])
    fixed, each = shares([point.n for point in points], [point.step_s for point in points])
    return MeshGrowth(
        model=law.model,
        points=law.points,
        run=law.run,
        step=law.step,
        finest=Laws(finest.run, finest.step),
        fixed_s=fixed,
        element_s=each,
    )


def _median(runs: list[Trajectory], time: str, n: int | None = None, **others: Any) -> Timing:
    """Repeats of a run as one timing; default ``n``: the number of elements. Raises NotDone for a run
    whose time says nothing."""
    for run in runs:
        done.require_run(f"a run of {n or run.cost.get('elements')}", run, settles=False)
    costs = [run.cost for run in runs]
    seconds = statistics.median(cost[time] for cost in costs)
    steps = statistics.median(cost["steps"] for cost in costs)
    return Timing(
        n=int(costs[0]["elements"]) if n is None else n,
        steps=steps,
        repeats=len(costs),
        time_s=seconds,
        wall_s=statistics.median(cost["wall_s"] for cost in costs),
        step_s=seconds / steps,
        **others,
    )


def pads(study: Study, name: str) -> tuple[Growth, ...]:
    """Law over the number of pads of each model; reference and rail compliance on the coarsest
    mesh. A mesh from a file cannot be coarsened. Then the reference is left out, because ten of its
    runs may take hours."""
    variants = pad_variants(study, name)
    wanted = (
        {}
        if isinstance(study.scene.rail, MeshTable)
        else {
            FINITE_ELEMENTS: [
                _coarsest(study, name, change, count) for count, change in variants.items()
            ]
        }
    )
    wanted[SPRINGS] = [
        study.lowfi(name, None, change, f"-pads-{count}") for count, change in variants.items()
    ]
    if study.scene.contact is not None:
        wanted[COMPLIANT] = [
            study.lowfi(
                name, None, change, f"-pads-{count}", coarse_walls(study, name, change), modes=0
            )
            for count, change in variants.items()
        ]
    with Board("growth, pads", len(wanted)) as board:
        return tuple(
            over_pads(model, runs, list(variants), board) for model, runs in wanted.items()
        )


def over_pads(model: str, runs: list[Run], counts: list[int], board: Board) -> Growth:
    """Alternating runs, so other load on the machine affects all numbers of pads alike."""
    fidelity, progress = runs[0].fidelity, board.callback(model)
    for run in runs:
        warm_up(run)
    rounds = []
    for repeat in range(_REPEATS[fidelity]):
        rounds.append([timed(run)[0] for run in runs])
        progress((repeat + 1) / _REPEATS[fidelity])
    points = [
        _median(list(repeats), _TIME[fidelity], count, status=repeats[0].status)
        for count, repeats in zip(counts, zip(*rounds))
    ]
    law = fitted(model, points)
    board.finished(model, f"{', '.join(map(str, counts))} pads timed")
    return law


def pad_variants(study: Study, name: str) -> dict[int, dict]:
    """Overrides by number of pads, for the numbers that are possible in the scene."""
    scene, found = study.condition(name), {}
    for share in _SHARES:
        count = share * len(scene.pads)
        change = with_pads(scene, int(count)) if count == int(count) else None
        if change and _possible(study, name, change, int(count)):
            found[int(count)] = change
    return found


def with_pads(scene: Scene, count: int) -> dict | None:
    """Override with ``count`` pads. Fewer pads: the rear ones, so the place of the exit does not
    change, and of a part of a band those farthest apart. More pads: more bands, evenly spaced from
    rear to front. None if ``count`` is no multiple of a band."""
    own = sorted(
        (pad.model_dump(mode="json") for pad in scene.pads), key=lambda pad: pad["position"][0]
    )
    places = sorted({pad["position"][0] for pad in own})
    rear = [pad for pad in own if pad["position"][0] == places[0]]
    if count <= len(rear):
        return {
            "pads": [rear[at] for at in np.linspace(0, len(rear) - 1, count).round().astype(int)]
        }
    if count <= len(own):
        return {"pads": own[:count]}
    bands, left = divmod(count, len(rear))
    if left or len(places) < 2:
        return None
    return {
        "pads": [
            pad | {"position": [float(x), *pad["position"][1:]]}
            for x in np.linspace(places[0], places[-1], bands)
            for pad in rear
        ]
    }


def _possible(study: Study, name: str, change: dict, count: int) -> bool:
    """Whether both models accept the scene with these pads."""
    from tipoff import highfi

    try:
        run = _coarsest(study, name, change, count)
        highfi.prepare(run.scene, run.numerics)
    except SceneError:
        return False
    return True


def _coarsest(study: Study, name: str, change: dict, count: int) -> Run:
    return study.highfi(name, change, f"-pads-{count}", 2.0 * study.settings.coarse_size)


def coarse_walls(study: Study, name: str, change: dict):
    """Rail compliance on the coarsest mesh, because the time of a surrogate does not depend on the
    mesh."""
    from tipoff import highfi

    return highfi.condense(
        study.condition(name).replace(change), element_size=2.0 * study.settings.coarse_size
    )


def effects(scene: Scene, ablation: Ablation) -> tuple[EffectTimes, ...]:
    """Times of the ablation study for each model."""
    found = []
    for fidelity, model in (("highfi", FINITE_ELEMENTS), ("lowfi", COMPLIANT)):
        time = {row.variant: row.time_s for row in ablation.rows if row.fidelity == fidelity}
        every, none = time["all effects"], time["no effect"]
        without = {
            name.removeprefix("without "): seconds
            for name, seconds in time.items()
            if name.startswith("without ")
        }
        asked = sum(effect not in scene.absent_effects() for effect in without)
        found.append(
            EffectTimes(
                model=model,
                none_s=none,
                all_s=every,
                ratio=every / none,
                ladder=_ladder(time, len(without)),
                asked=(asked, time["as the scene asks"]),
                effects=tuple(
                    EffectTime(effect, every - seconds, (every - seconds) / none)
                    for effect, seconds in without.items()
                ),
            )
        )
    return tuple(found)


def _ladder(time: dict[str, float], count: int) -> tuple[Rung, ...]:
    """The nested sets of the ablation study, which need no further kernels. Friction needs contact."""
    sets = [
        ("none", 0, "no effect"),
        ("all but contact and friction", count - 2, "without contact"),
        ("contact too", count - 1, "without friction"),
        ("friction too", count, "all effects"),
    ]
    if {"without contact", "without friction"} - set(time):
        sets = [sets[0], ("all", count, "all effects")]
    return tuple(Rung(words, on, time[variant]) for words, on, variant in sets)
