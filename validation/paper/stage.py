"""Stage ``paper``: inputs inferred from the paper's printed rates, and its tables compared with
those of the best set found.

Every finished search is stored. So an interrupted stage continues with the next search, and more starts
add to the stored searches.
"""

import math
from concurrent.futures import as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from tipoff import cache, sources
from tipoff.faults import Fault, SceneError
from tipoff.files import content_hash, write_text
from tipoff.scenes.rail import SectionTable
from tipoff.scenes.scene import Scene, load
from tipoff.studies.agreement import stage as compare
from tipoff.studies.render.document import with_figures
from tipoff.studies.sweeps import stage as sweeps
from tipoff.studies.sweeps.knee import Growth
from tipoff.workspace.progress import Board, team
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError
from tipoff.workspace.words import counted
from validation import published
from validation.paper import (
    catalogued,
    exits,
    inputs,
    misfit,
    results,
    scene_file,
    solutions,
    summary,
)
from validation.paper import page as drawn

NAME = "paper"
SCENE = "paper_like.toml"
CATALOGUED = "paper_like"  # scene of the catalogue with the best set of an earlier run
STRESSES = (0.0, 1.0)  # without and with the rates that the paper calls negligible
_SEARCHES: cache.Cache[solutions.Search] = cache.documents(solutions.plain, solutions.restored)
_WRITTEN = 1e-5  # relative: a scene file has nine digits of most numbers, six of the mounts


@dataclass(frozen=True)
class PaperOptions:
    """``starts`` searches for each stress, and the ``plan`` of each."""

    starts: int = 3
    plan: solutions.Plan = solutions.Plan()


def run(study: Study, options: PaperOptions = PaperOptions()) -> Made[dict]:
    """The searches, the ranges of every input, and the best set with the printed tables; writes the
    best set as a scene, and every end and admissible point as netCDF.

    Raises SceneError for a scene that ``require`` refuses, StudyError if no scene file can contain
    the best set.
    """
    require(study.scene)

    def make() -> tuple[dict, list[Path]]:
        base = _base(study.scene)
        # before the searches, which take long
        with TemporaryDirectory() as folder:
            _write(base, np.full(len(inputs.UNKNOWNS), 0.5), np.zeros((5, 3)), Path(folder, SCENE))
        found = _searches(study, base, options)
        best = min(found, key=summary.misfit_of)
        path, data = study.path(SCENE), study.path(f"{NAME}.nc")
        _write(base, best.shares, best.rates, path)
        left = exits.run(misfit.Launcher(base, options.plan.tolerances[-1]), best.shares)
        results.save(data, found, found.index(best), left)
        result = {
            "asked": STAGE.plain(options),
            "admissible_deg_s": solutions.ADMISSIBLE,
            "negligible_deg_s": misfit.NEGLIGIBLE,
            "scatter_deg_s": misfit.SCATTER.tolist(),
            "searches": [summary.of_search(item) for item in found],
            "best": found.index(best),
            "inputs": summary.ranges(found, best),
            "admissible": summary.counted(found),
            "exit": exits.summary(left),
            "known": catalogued.errors(load(CATALOGUED), options.plan.tolerances[-1]),
            "front": summary.front(found).tolist(),
            "slips": published.slips(),
            "headline": published.headline(),
            "scene_file": study.relative(path),
            "data": study.relative(data),
        }
        result, pictures = with_figures(result, drawn.figures, study.path("figures"))
        return result, [path, data, *pictures]

    return with_present(study, STAGE.run(study, options, make))


def stored(study: Study) -> Made[dict] | None:
    """The result, if it was made from the present scene, code and settings."""
    found = STAGE.stored(study)
    return found and with_present(study, found)


def require(scene: Scene) -> None:
    """Raise SceneError with every fault of a ``scene`` whose inputs the searches cannot replace."""
    impact = scene.contact is not None and scene.contact.law == "impact"
    corners = {(x > 0.0, y > 0.0, z > 0.0) for x, y, z in (pad.position for pad in scene.pads)}
    wrong = [
        Fault(scene.name, key, given, expected)
        for holds, key, given, expected in (
            (
                isinstance(scene.rail, SectionTable),
                "rail",
                f"a {scene.rail.GIVEN_BY}",
                "the built-in section, because its ends are searched",
            ),
            (
                scene.thermal is None,
                "thermal",
                "a table",
                "absent, because the searches have no thermal offset",
            ),
            (
                impact,
                "contact.law",
                "another law, or no contact",
                "impact, whose constants the paper prints",
            ),
            (
                scene.thrust.kind == "gaussian",
                "thrust.kind",
                scene.thrust.kind,
                "gaussian, as in the paper",
            ),
            (
                scene.friction is not None and hasattr(scene.friction, "static"),
                "friction",
                "absent",
                "a table with static and dynamic",
            ),
            (
                len(scene.pads) == len(corners) == 8,
                "pads",
                counted(len(scene.pads), "pad"),
                "eight, one at each corner of the body",
            ),
            (
                scene.thrust_offset is not None,
                "thrust_offset",
                "absent",
                "the misalignment of the paper's Table 1",
            ),
        )
        if not holds
    ]
    if wrong:
        raise SceneError(wrong)


def _base(scene: Scene) -> Scene:
    """The scene with the misalignment of the paper's Table 1."""
    return scene.replace({"thrust_offset.misalignment.axial": f"{published.angles()[1][0]} deg"})


def _write(base: Scene, shares: np.ndarray, rates: np.ndarray, path: Path) -> None:
    """Write the set at ``shares`` (p,) as a scene that extends ``base`` by its name. Raises
    StudyError unless the file loads and is the searched scene: overrides of a scene of the
    catalogue are not in the file."""
    write_text(path, scene_file.scene(base, inputs.values(shares), rates))
    cannot = (
        f"the best set cannot be kept as {path.name}, which extends {base.name!r} of the catalogue"
    )
    try:
        kept = load(path)
    except SceneError as fault:
        raise StudyError(f"{cannot}, because it does not load: {fault}") from fault
    if other := _differing(kept.physics(), misfit.Launcher(base).scene(shares).physics()):
        raise StudyError(f"{cannot}, because the given scene differs: {', '.join(other)}")


def _differing(first, second, key: str = "") -> list[str]:
    """Dotted keys at which two scenes (``Scene.physics``) differ by more than the rounding of a
    scene file."""
    if isinstance(first, dict) and isinstance(second, dict):
        return [
            name
            for entry in {**first, **second}
            for name in _differing(
                first.get(entry), second.get(entry), f"{key}.{entry}".lstrip(".")
            )
        ]
    if isinstance(first, list) and isinstance(second, list) and len(first) == len(second):
        return [
            name
            for number, pair in enumerate(zip(first, second))
            for name in _differing(*pair, f"{key}.{number}")
        ]
    if isinstance(first, float) and isinstance(second, float):
        return [] if math.isclose(first, second, rel_tol=_WRITTEN, abs_tol=1e-12) else [key]
    return [] if first == second else [key]


def _searches(study: Study, base: Scene, options: PaperOptions) -> list[solutions.Search]:
    """All searches in order, ``workers`` at a time; Ctrl-C ends the running ones and starts no
    other."""
    plans = [(stress, seed) for seed in range(options.starts) for stress in STRESSES]
    with Board(NAME, len(plans)) as board, team(board, study.settings.workers) as pool:

        def one(stress: float, seed: int) -> solutions.Search:
            path = study.path(f"{NAME}/search-{stress:g}-{seed}.json")
            key = content_hash(
                base.hash,
                sources.program("tipoff.lowfi", "validation.paper.solutions"),
                STAGE.plain(options)["plan"],
                stress,
                seed,
            )
            if (kept := _SEARCHES.get(path, key, "it is searched again")) is not None:
                return kept
            label = f"search {seed + 1}, {'all five conditions' if stress else 'three conditions'}"
            found = solutions.run(
                lambda tolerance: misfit.Launcher(base, tolerance),
                stress,
                seed,
                options.plan,
                board.callback(label),
            )
            _SEARCHES.put(path, key, found)
            board.finished(
                label,
                f"largest error of nine rates {np.abs(misfit.nine(found.rates)).max():.3g} deg/s, "
                f"largest rate of conditions 1 and 5 "
                f"{solutions.largest_negligible(found.rates):.3g} deg/s",
            )
            return found

        pending = [pool.submit(one, *plan) for plan in plans]
        for future in as_completed(pending):
            future.result()
    return [future.result() for future in pending]


STAGE: Stage[dict] = Stage(NAME, __name__, options=PaperOptions)


def with_present(study: Study, made: Made[dict]) -> Made[dict]:
    """The result with values that are not stored in it: the cost of both fidelities, if the present
    agreement study has it, the plateaus of the present sweeps, and whether the best set is the
    catalogue's scene."""
    found, kept = made.result, load(CATALOGUED)
    best = misfit.Launcher(_base(study.scene)).scene(
        inputs.shares(found["searches"][found["best"]]["values"])
    )
    ours, swept = compare.stored(study), sweeps.STAGE.stored(study)
    present = {
        "ours": ours and asdict(ours.speedup),
        "plateaus": {
            factor.name: [_plateau(bent) for bent in factor.growth.values()]
            for factor in swept.result.launches[0].factors
        }
        if swept and swept.result.asked.vary is None
        else None,
        "catalogue": {
            "name": kept.name,
            "same": not _differing(kept.physics(), best.physics()),
            "description": kept.description,
        },
    }
    return Made(found | present, made.document | present)


def _plateau(found: Growth | None) -> str | None:
    """Where a rate stops growing, or the verdict."""
    if found is None:
        return None
    if found.verdict != "plateau":
        return found.verdict
    return f"{found.knee:.2f} ({found.low:.2f} to {found.high:.2f})"
