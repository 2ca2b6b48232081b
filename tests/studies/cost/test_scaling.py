"""Growth of cost: exponents against exact laws, scenes of other pads, prices of effects."""

import numpy as np
import pytest

from tests.studies.shown import html
from tipoff import scenes
from tipoff.mechanics.model import build
from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.studies.cost import scaling
from tipoff.studies.cost import scaling_page as page
from tipoff.studies.cost.scaling import effects, fitted, power_law, shares, with_pads
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study

SIZES = [520, 2420, 4500, 19360]


def test_exponent_of_an_exact_law():
    found = power_law(SIZES, [3e-4 * size**1.25 for size in SIZES])
    assert found["exponent"] == pytest.approx(1.25, rel=1e-12) and found[
        "standard_error"
    ] == pytest.approx(0.0, abs=1e-9)
    assert power_law(SIZES[:2], SIZES[:2])["standard_error"] is None


def test_single_size_has_no_exponent():
    """A mesh from a file is the same whatever element size is asked for; nor does the page or its
    picture stumble over it."""
    points = [
        {"n": 500, "steps": 10, "time_s": time, "element_size_m": 1e-3, "repeats": 1}
        for time in (1.0, 1.1, 0.9)
    ]
    law, finest = fitted(FINITE_ELEMENTS, points), fitted(FINITE_ELEMENTS, points[-2:])
    assert law["run"] == law["step"] == {"exponent": None, "standard_error": None} and shares(
        [500] * 3, [1.0, 1.1, 0.9]
    ) == (None, None)
    found = {
        "elements": law
        | {
            "finest": {"run": finest["run"], "step": finest["step"]},
            "fixed_s": None,
            "element_s": None,
        },
        "pads": [fitted(SPRINGS, points[:1])],
        "effects": effects(scenes.load("tiny"), ABLATION),
    }
    assert "there is only one" in html(page.tables(found))
    assert [len(panel.lines) for panel in page.picture(found).panels] == [2, 1, 2]


def test_standard_error_covers_the_scatter_it_is_made_of():
    """Oracle: of many laws with the same scatter of 5 %, exponents lie as far apart as each says of
    itself on the average."""
    draw, sizes = np.random.default_rng(1), np.geomspace(1.0, 16.0, 5)
    laws = [power_law(sizes, sizes * np.exp(0.05 * draw.standard_normal(5))) for _ in range(2000)]
    spread = np.std([law["exponent"] for law in laws])
    assert np.sqrt(np.mean([law["standard_error"] ** 2 for law in laws])) == pytest.approx(
        spread, rel=0.05
    )


def test_steps_and_runs_have_laws_of_their_own():
    """Elements that shrink alike along all edges: 1 for a step, 4/3 for a run."""
    points = [
        {"n": n, "steps": 100.0 * n ** (1 / 3), "time_s": 1e-6 * n * 100.0 * n ** (1 / 3)}
        for n in SIZES
    ]
    law = fitted("m", points)
    assert law["step"]["exponent"] == pytest.approx(1.0) and law["run"][
        "exponent"
    ] == pytest.approx(4.0 / 3.0)
    assert law["points"][0]["step_s"] == pytest.approx(520e-6)


def test_what_is_the_same_on_any_mesh_is_told_from_the_elements():
    """t = a + b n is recovered; control: the power law of the same points is off 1, the exponent of
    what the elements alone take."""
    times = [40e-6 + 9e-9 * size for size in SIZES]
    assert shares(SIZES, times) == pytest.approx((40e-6, 9e-9))
    assert power_law(SIZES, times)["exponent"] < 0.6


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
    monkeypatch.setattr(
        scaling, "over_pads", lambda model, runs, counts, board: {"model": model, "counts": counts}
    )
    monkeypatch.setattr(scaling, "coarse_walls", lambda study, name, change: None)
    models = {
        name: [
            law["model"]
            for law in scaling.pads(Study(scenes.load(name), tmp_path, defaults(name)), "phi15")
        ]
        for name in ("channel", "tiny")
    }
    assert models == {
        "channel": [SPRINGS, COMPLIANT],
        "tiny": [FINITE_ELEMENTS, SPRINGS, COMPLIANT],
    }


ABLATION = {
    "rows": [
        {"fidelity": fidelity, "variant": variant, "time_s": factor * seconds}
        for fidelity, factor in (("highfi", 1e3), ("lowfi", 1.0))
        for variant, seconds in TIMES.items()
    ]
}


def test_prices_of_effects():
    scene = scenes.load("tiny")
    reference, surrogate = effects(scene, ABLATION)
    assert reference["ratio"] == surrogate["ratio"] == 2.0 and surrogate["model"] == COMPLIANT
    assert {item["effect"]: item["time_s"] for item in surrogate["effects"]} == {
        "contact": 4.0,
        "friction": 1.0,
        "gravity": -0.5,
    }
    assert [(step["on"], step["time_s"]) for step in surrogate["ladder"]] == [
        (0, 5.0),
        (1, 6.0),
        (2, 9.0),
        (3, 10.0),
    ]
    assert surrogate["asked"] == [2, 9.5]  # the scene has no gravity
    without = {"rows": [row for row in ABLATION["rows"] if row["variant"] != "without contact"]}
    assert [step["on"] for step in effects(scene, without)[0]["ladder"]] == [0, 2]


def test_page_shows_exponents_with_their_errors():
    law = fitted(
        SPRINGS, [{"n": n, "steps": 10, "time_s": 1e-3 * n**0.5, "repeats": 1} for n in (1, 2, 4)]
    )
    meshes = fitted(
        FINITE_ELEMENTS,
        [
            {"n": n, "steps": 10, "time_s": 1e-3 * n, "element_size_m": 1e-3, "repeats": 3}
            for n in SIZES
        ],
    )
    finest = {
        "run": {"exponent": 1.3, "standard_error": None},
        "step": {"exponent": 0.9, "standard_error": None},
    }
    found = {
        "elements": meshes | {"finest": finest, "fixed_s": 4e-5, "element_s": 9e-9},
        "pads": [law],
        "effects": effects(scenes.load("tiny"), ABLATION),
    }
    shown = html(page.tables(found))
    assert "0.50 ± 0.00" in shown and ">1.30<" in shown and "gravity alone" in shown
    assert [len(panel.lines) for panel in page.picture(found).panels] == [3, 2, 2]
