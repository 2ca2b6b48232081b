"""Stage ``paper``: what the inputs that the paper does not print must have been, and its tables beside those of the best set found.

Every search is kept as it ends, so that a stage that was stopped goes on with the next, and more starts add to those there are.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.faults import Fault, SceneError
from scenes.files import content_hash, source_hash, write_json, write_text
from scenes.scene import Scene
from studies import published
from studies.inference import inputs, misfit, solutions, toml
from studies.progress import Board
from studies.report import paper as drawn
from studies.report.chart import to_files
from studies.store import SOURCES
from studies.study import Study, read

NAME = "paper"
SCENE = "paper_like.toml"
STRESSES = (0.0, 1.0)  # without and with the rates that the paper calls negligible
_SEARCHED = ("scenes", "lowfi", "studies/inference", "studies/published")  # a search outlives a change of anything else


@dataclass(frozen=True)
class Asked:
    """``starts`` searches for each stress, and the ``plan`` of each."""

    starts: int = 3
    plan: solutions.Plan = solutions.Plan()


def run(study: Study, asked: Asked = Asked()) -> dict:
    """The searches, what they tell of every input, and the best set beside the printed tables; writes it as a scene too."""
    require(study.scene)

    def make() -> tuple[dict, list[Path]]:
        found = _searches(study, asked)
        best = min(found, key=misfit_of)
        path = study.path(SCENE)
        write_text(path, toml.scene(study.scene, inputs.values(best.shares), best.rates))
        result = {"asked": {"starts": asked.starts, "plan": _plain(asked.plan)},
                  "admissible_deg_s": solutions.ADMISSIBLE,
                  "negligible_deg_s": misfit.NEGLIGIBLE, "scatter_deg_s": misfit.SCATTER.tolist(),
                  "searches": [_summary(item) for item in found], "best": found.index(best), "inputs": _told(found, best),
                  "front": solutions.front(*np.vstack([item.front for item in found]).T).tolist(), "slips": published.slips(),
                  "headline": published.headline(), "ours": _speed(study),
                  "scene_file": study.relative(path)}
        pictures = [file for chart in drawn.charts(result) for file in to_files(chart, study.path("figures"))]
        return result, [path, *pictures]

    return study.stage(NAME, _key(study, asked), make)


def stored(study: Study) -> dict | None:
    """The result, if it was made from the present scene, code and settings."""
    return study.stored(NAME, lambda found: _key(study, _asked(found["asked"])))


def require(scene: Scene) -> None:
    """Raise SceneError unless ``scene`` is one whose inputs the searches can replace: every fault of it."""
    impact = scene.contact is not None and scene.contact.law == "impact"
    corners = {(x > 0.0, y > 0.0, z > 0.0) for x, y, z in (pad.position for pad in scene.pads)}
    wrong = [Fault(scene.name, key, given, expected) for holds, key, given, expected in (
        (impact, "contact.law", "another law, or no contact", "impact, of which the paper prints the constants"),
        (scene.thrust.kind == "gaussian", "thrust.kind", scene.thrust.kind, "gaussian, as the paper fits its thrust"),
        (scene.friction is not None and hasattr(scene.friction, "static"), "friction", "absent", "a table with static and dynamic"),
        (len(scene.pads) == len(corners) == 8, "pads", f"{len(scene.pads)} pads", "eight, one at each corner of the body"),
        (scene.thrust_offset is not None, "thrust_offset", "absent", "the misalignment of the paper's Table 1")) if not holds]
    if wrong:
        raise SceneError(wrong)


def _searches(study: Study, asked: Asked) -> list[solutions.Search]:
    base = study.scene.replace({"thrust_offset.misalignment.axial": f"{published.angles()[1][0]} deg"})
    plans = [(stress, seed) for seed in range(asked.starts) for stress in STRESSES]
    with Board(NAME, len(plans)) as board, ThreadPoolExecutor(study.settings.workers) as pool:

        def one(stress: float, seed: int) -> solutions.Search:
            path = study.path(f"{NAME}/search-{stress:g}-{seed}.json")
            key = content_hash(base.hash, source_hash(*_SEARCHED), _plain(asked.plan), stress, seed)
            kept = read(path)
            if kept and kept.get("key") == key:
                return solutions.restored(kept)
            label = f"search {seed + 1}, {'all five conditions' if stress else 'three conditions'}"
            found = solutions.run(lambda tolerance: misfit.Launcher(base, tolerance), stress, seed, asked.plan,
                                  board.callback(label))
            write_json(path, {"key": key, **solutions.plain(found)})
            board.finished(label, f"largest error of nine rates {np.abs(misfit.nine(found.rates)).max():.3g} deg/s, "
                                  f"largest rate of conditions 1 and 5 {solutions.largest_negligible(found.rates):.3g} deg/s")
            return found

        return [item.result() for item in [pool.submit(one, *plan) for plan in plans]]


def misfit_of(found: solutions.Search) -> float:
    """Misfit with the rates of conditions 1 and 5 at full weight, whatever the search gave them."""
    return misfit.whole(found.rates, found.changed, 1.0)


def _summary(found: solutions.Search) -> dict:
    return {"stress": found.stress, "seed": found.seed, "largest_error_deg_s": float(np.abs(misfit.nine(found.rates)).max()),
            "largest_negligible_deg_s": solutions.largest_negligible(found.rates),
            "largest_deviation_error_deg_s": solutions.largest_of_deviations(found.rates, found.changed),
            "misfit": misfit_of(found),
            "rates_deg_s": found.rates.tolist(), "changed_deg_s": found.changed.tolist(), "values": inputs.values(found.shares),
            "admissible": len(found.admissible)}


def _told(found: list[solutions.Search], best: solutions.Search) -> list[dict]:
    """Every input: bounds, best, range of the admissible set and its share of the bounds on the scale of the search; None where the
    set is empty."""
    points = np.vstack([item.admissible for item in found])
    rows = []
    for number, item in enumerate(inputs.UNKNOWNS):
        ends = [float(end) for end in np.quantile(points[:, number], (0.0, 1.0))] if len(points) else None
        rows.append({"name": item.name, "unit": item.unit, "low": item.factor * item.low, "high": item.factor * item.high,
                     "best": item.factor * item.value(best.shares[number]),
                     "from": ends and item.factor * item.value(ends[0]), "to": ends and item.factor * item.value(ends[1]),
                     "share": ends and ends[1] - ends[0], "reason": item.reason})
    return rows


def _speed(study: Study) -> dict | None:
    """What the agreement study measured of both fidelities, if it was made."""
    return (read(study.path("agreement.json")) or {}).get("speedup")


def _key(study: Study, asked: Asked) -> str:
    return study.key(SOURCES["lowfi"], NAME, asked.starts, _plain(asked.plan), _speed(study))


def _asked(plain: dict) -> Asked:
    """Inverse of what a result holds of it."""
    plan = plain["plan"]
    return Asked(plain["starts"], solutions.Plan(**plan | {"tolerances": tuple(plan["tolerances"])}))


def _plain(plan: solutions.Plan) -> dict:
    return plan._asdict() | {"tolerances": list(plan.tolerances)}


def lines(found: dict) -> list[str]:
    """The result in words and units."""
    best = found["searches"][found["best"]]
    said = [f"best of {len(found['searches'])} searches: a printed rate missed by {best['largest_error_deg_s']:.3g} deg/s at most, "
            f"a deviation by {best['largest_deviation_error_deg_s']:.3g} deg/s; rates of conditions 1 and 5 up to "
            f"{best['largest_negligible_deg_s']:.3g} deg/s"]
    for item in found["inputs"]:
        kept = "nothing admissible" if item["share"] is None else f"admissible {item['from']:.3g} to {item['to']:.3g}"
        said.append(f"  {item['name']:16}{item['best']:.4g} {item['unit']}, {kept} of {item['low']:.3g} to {item['high']:.3g}")
    return [*said, *(f"  note          {words}" for words in found["slips"]), f"  scene         {found['scene_file']}"]
