"""Growth of cost: exponents against exact laws, scenes of other pads, prices of effects."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.studies.shown import html
from tipoff import scenes
from tipoff.files import read_json
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.scenes.scene_model import build
from tipoff.studies.ablation.stage import Ablation, VariantRun
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study
from validation.scaling import growth as scaling
from validation.scaling import page, stage, trends
from validation.scaling.growth import effects, fitted, power_law, shares, with_pads
from validation.scaling.results import Laws, MeshGrowth, PowerLaw, Scaling, Timing

SIZES = [520, 2420, 4500, 19360]


def timing(n, steps, seconds, element_size=None) -> Timing:
    """A timing of one run."""
    return Timing(
        n=n,
        steps=steps,
        repeats=1,
        time_s=seconds,
        wall_s=seconds,
        step_s=seconds / steps,
        element_size_m=element_size,
    )


def growth(meshes, finest, fixed, each, pads) -> Scaling:
    """All growth of the scene tiny."""
    elements = MeshGrowth(**vars(meshes), finest=finest, fixed_s=fixed, element_s=each)
    priced = effects(scenes.load("tiny"), ABLATION)
    return Scaling(
        condition="phi15",
        elements=elements,
        pads=(pads,),
        effects=priced,
        trends=(),
        hardware={},
    )


def test_exponent_of_an_exact_law():
    found = power_law(SIZES, [3e-4 * size**1.25 for size in SIZES])
    assert found.exponent == pytest.approx(1.25, rel=1e-12)
    assert found.standard_error == pytest.approx(0.0, abs=1e-9)
    assert power_law(SIZES[:2], SIZES[:2]).standard_error is None


def test_single_size_has_no_exponent():
    """A mesh from a file is the same whatever element size is asked for; nor does the page or its
    picture stumble over it."""
    points = [timing(500, 10, time, 1e-3) for time in (1.0, 1.1, 0.9)]
    law = fitted(FINITE_ELEMENTS, points)
    assert law.run == law.step == PowerLaw(None, None)
    assert shares([500] * 3, [1.0, 1.1, 0.9]) == (None, None)
    found = growth(law, Laws(law.run, law.step), None, None, fitted(SPRINGS, points[:1]))
    shown = html(page.tables(found))
    assert "there is only one" in shown and "gravity alone" in shown
    assert [len(panel.lines) for panel in page.picture(found).panels] == [2, 1, 2]
    # Control: several sizes, and pads in three models
    several = page.picture(stage.STAGE.read(read_json(Path(__file__).with_name("kept.json"))))
    assert [len(panel.lines) for panel in several.panels] == [3, 6, 2]


def test_standard_error_covers_the_scatter_it_is_made_of():
    """Oracle: of many laws with the same scatter of 5 %, exponents lie as far apart as each says of
    itself on the average."""
    draw, sizes = np.random.default_rng(1), np.geomspace(1.0, 16.0, 5)
    laws = [power_law(sizes, sizes * np.exp(0.05 * draw.standard_normal(5))) for _ in range(2000)]
    spread = np.std([law.exponent for law in laws])
    assert np.sqrt(np.mean([law.standard_error**2 for law in laws])) == pytest.approx(
        spread, rel=0.05
    )


def test_steps_and_runs_have_laws_of_their_own():
    """Elements that shrink alike along all edges: 1 for a step, 4/3 for a run."""
    steps = [100.0 * n ** (1 / 3) for n in SIZES]
    law = fitted("m", [timing(n, each, 1e-6 * n * each) for n, each in zip(SIZES, steps)])
    assert law.step.exponent == pytest.approx(1.0)
    assert law.run.exponent == pytest.approx(4.0 / 3.0)
    assert law.points[0].step_s == pytest.approx(520e-6)


def test_what_is_the_same_on_any_mesh_is_told_from_the_elements():
    """t = a + b n is recovered; control: the power law of the same points is off 1, the exponent of
    what the elements alone take."""
    times = [40e-6 + 9e-9 * size for size in SIZES]
    assert shares(SIZES, times) == pytest.approx((40e-6, 9e-9))
    assert power_law(SIZES, times).exponent < 0.6


@pytest.mark.parametrize("count, bands", [(1, 1), (2, 1), (4, 1), (8, 2), (12, 3), (16, 4)])
def test_other_pads_make_a_sound_scene_with_the_same_exit(count, bands):
    """The rearmost edge, which decides the exit, stays; control: leaving the rear band out moves it
    by the wheelbase."""
    scene = scenes.load("reference").condition("phi35")
    found = scene.replace(with_pads(scene, count))
    assert len(found.pads) == count and len({pad.position[0] for pad in found.pads}) == bands
    assert (
        len({pad.position for pad in found.pads}) == count
        and build(found).faces.axis.size == 2 * count
    )
    assert min(pad.position[0] for pad in found.pads) == min(pad.position[0] for pad in scene.pads)
    front = scene.replace({"pads": [pad.model_dump(mode="json") for pad in scene.pads[4:]]})
    assert min(pad.position[0] for pad in front.pads) == pytest.approx(0.08)


def test_own_pads_are_left_as_they_are_and_two_are_opposite():
    scene = scenes.load("reference")
    assert scene.replace(with_pads(scene, 8)).hash == scene.hash
    first, second = (pad["position"] for pad in with_pads(scene, 2)["pads"])
    assert first[1] == -second[1] and first[2] == -second[2]


def test_numbers_that_make_no_bands_are_left_out():
    scene = scenes.load("reference")
    assert with_pads(scene, 10) is None
    assert with_pads(scene.replace(with_pads(scene, 4)), 8) is None  # between which bands?


TIMES = {
    "all effects": 10.0,
    "without contact": 6.0,
    "without friction": 9.0,
    "without gravity": 10.5,
    "as the scene asks": 9.5,
    "no effect": 5.0,
}


def test_mesh_from_a_file_is_not_run_ten_times(monkeypatch, tmp_path):
    """Control: the built-in rail has a coarse mesh, and the reference is asked."""
    monkeypatch.setattr(scaling, "over_pads", lambda model, runs, counts, board: model)
    monkeypatch.setattr(scaling, "coarse_walls", lambda study, name, change: None)
    models = {
        name: list(scaling.pads(Study(scenes.load(name), tmp_path, defaults(name)), "phi15"))
        for name in ("channel", "tiny")
    }
    assert models == {
        "channel": [SPRINGS, COMPLIANT],
        "tiny": [FINITE_ELEMENTS, SPRINGS, COMPLIANT],
    }


def test_runs_over_pads_have_no_modes(monkeypatch, tmp_path):
    """A number that each chooses would be another change."""
    seen = {}

    def over_pads(model, runs, counts, board):
        seen[model] = [run.numerics.modes for run in runs if run.fidelity == "lowfi"]

    monkeypatch.setattr(scaling, "over_pads", over_pads)
    walls = SimpleNamespace(hash="0", flexibility=1.0)
    monkeypatch.setattr(scaling, "coarse_walls", lambda study, name, change: walls)
    scaling.pads(Study(scenes.load("tiny"), tmp_path, defaults("tiny")), "phi15")
    assert len(seen[COMPLIANT]) > 2 and set(seen[COMPLIANT]) == {0}


def test_longer_rails_are_rails_end_to_end():
    scene = scenes.load("reference")
    rail, longer = scene.rail, trends.lengthened(scene, 3).rail
    length = rail.end - rail.start
    assert longer.end - longer.start == pytest.approx(3.0 * length, rel=1e-12)
    assert len(longer.mounts) == 3 * len(rail.mounts)
    first, last = rail.mounts[0], longer.mounts[-len(rail.mounts)]
    assert last.start == pytest.approx(first.start + 2.0 * length, rel=1e-12)
    assert trends.lengthened(scenes.load("channel"), 2) is None  # its rail is a file


def test_each_trend_has_its_size_and_the_exponent_of_the_method(monkeypatch, tmp_path):
    """With calls of 1 s for each unit of their size, and of 1 s shared by threads."""
    scene = scenes.load("tiny")
    study = Study(scene, tmp_path, replace(defaults(scene), element_size=8e-3))
    laws = iter([(1.0, 2.0, 4.0), (256.0, 1024.0, 4096.0), (1.0, 0.5), (1.0, 0.5)])
    monkeypatch.setattr(trends, "thread_counts", lambda: [1, 2])
    monkeypatch.setattr(trends, "seconds", lambda calls, clock: list(next(laws))[: len(calls)])
    found = trends.measured(study, next(iter(study.conditions)))
    assert [trend.size for trend in found] == [
        "length of the rails (m)",
        "cases",
        "threads",
        "threads",
    ]
    for trend in found:
        assert trend.law.exponent == pytest.approx(trend.expected, abs=1e-9)
    # Control: without contact, no compliance
    laws = iter([(256.0, 1024.0, 4096.0), (1.0, 0.5), (1.0, 0.5)])
    bare = Study(scene.replace({"contact": None, "friction": None}), tmp_path, study.settings)
    assert len(trends.measured(bare, next(iter(bare.conditions)))) == 3


def rows(times) -> tuple[VariantRun, ...]:
    """Rows of the ablation study with these ``times`` (s) of the surrogate."""
    nothing = dict.fromkeys(
        ("ns_per_step", "time_ratio", "settled_rate_deg_s", "settled_rate_change_deg_s")
    )
    return tuple(
        VariantRun(
            fidelity=fidelity,
            variant=variant,
            status="exited",
            time_s=factor * seconds,
            evaluated=(),
            **nothing,
        )
        for fidelity, factor in (("highfi", 1e3), ("lowfi", 1.0))
        for variant, seconds in times.items()
    )


ABLATION = Ablation("phi15", {}, 4e-3, rows(TIMES), {})


def test_prices_of_effects():
    scene = scenes.load("tiny")
    reference, surrogate = effects(scene, ABLATION)
    assert reference.ratio == surrogate.ratio == 2.0 and surrogate.model == COMPLIANT
    assert {item.effect: item.time_s for item in surrogate.effects} == {
        "contact": 4.0,
        "friction": 1.0,
        "gravity": -0.5,
    }
    ladder = [(rung.on, rung.time_s) for rung in surrogate.ladder]
    assert ladder == [(0, 5.0), (1, 6.0), (2, 9.0), (3, 10.0)]
    assert surrogate.asked == (2, 9.5)  # the scene has no gravity
    others = {name: seconds for name, seconds in TIMES.items() if name != "without contact"}
    without = replace(ABLATION, rows=rows(others))
    assert [rung.on for rung in effects(scene, without)[0].ladder] == [0, 2]


@pytest.mark.slow
def test_cost_grows_with_elements_and_hardly_with_pads(tmp_path):
    """Elements are the work of the reference on any mesh; pads only where they touch."""
    study = Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
    made = stage.run(study)
    found = made.document
    assert "4/3" in html(page.draw(made.result))
    assert [point["n"] for point in found["elements"]["points"]] == sorted(
        point["n"] for point in found["elements"]["points"]
    )
    assert found["elements"]["run"]["exponent"] > 0.0
    assert [law["model"] for law in found["pads"]] == ["finite-elements", "springs", "compliant"]
    assert all([point["n"] for point in law["points"]] == [1, 2, 4, 8, 16] for law in found["pads"])
    assert all(point["status"] == "exited" for law in found["pads"] for point in law["points"])
    assert found["pads"][0]["run"]["exponent"] < 0.5
    assert all(item["ratio"] > 0.0 for item in found["effects"])
