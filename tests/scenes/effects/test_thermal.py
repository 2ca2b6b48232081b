"""Temperature of the rails as a scene states it: units of differences, its fields,
and that other scenes keep their hash."""

import numpy as np
import pytest

from tests.scenes.support import small
from tipoff.mechanics.laws.thermal import fields
from tipoff.scenes import SceneError, load, parse, scene_model
from tipoff.scenes.rail_compliance import digest
from tipoff.scenes.variation import Variations

EXPANSION = "23.6e-6 1/K"


def warm(expansion=EXPANSION, **table):
    raw = small(thermal=table or {"mean": "20 K"})
    if expansion is not None:
        raw["rail"]["material"]["expansion"] = expansion
    return raw


@pytest.mark.parametrize("text", ["20 K", "20 delta_degC", "36 delta_degF", "20000 mK"])
def test_a_difference_of_temperature(text):
    assert parse(warm(mean=text)).thermal.mean == pytest.approx(20.0, rel=1e-14)


@pytest.mark.parametrize("text", ["2 K/mm", "2 delta_degC/mm", "2 degC/mm", "2000 K/m"])
def test_a_gradient(text):
    """Per length even degC can only mean a difference."""
    assert parse(warm(gradient={"y": text})).thermal.gradient.y == pytest.approx(2000.0, rel=1e-14)


def test_rails_need_an_expansion():
    """By an override, and in a case of an ensemble, of one key or of the other."""
    cold, found = parse(small()), parse(warm())
    for scene, row in ((cold, {"thermal.mean": 20.0}), (found, {"rail.material.expansion": None})):
        for vary in (scene.replace, Variations(scene).of):
            with pytest.raises(SceneError, match="rails that expand"):
                vary(row)
    assert Variations(found).of({"thermal.mean": 7.0}).thermal.mean == 7.0


def test_fields():
    """Free strain at the ends of the rail and on its sides, amounts times fields: alpha (mean +
    gradient . (X - X_m))."""
    scene = parse(
        warm(mean="20 K", gradient={"x": "0.1 K/mm", "y": "-0.2 K/mm"}, platform_strain=1e-4)
    )
    amounts, middle = scene.thermal.record(scene.rail)
    assert middle == 0.0 and amounts[4] == 1e-4
    strain = (
        fields(np.array([[0.1, 0.0, 0.0], [0.0, 0.1, 0.5], [0.0, -0.1, 0.0]]), middle) @ amounts[:4]
    )
    assert strain == pytest.approx(23.6e-6 * np.array([30.0, 0.0, 40.0]), abs=1e-18)
    assert fields(np.array([[0.3, 0.0, 0.0]]), 0.1)[0] == pytest.approx([1.0, 0.2, 0.0, 0.0])


def test_absent_table_is_no_effect():
    cold = parse(small())
    assert (
        cold.thermal is None
        and "thermal" in cold.absent_effects()
        and scene_model.build(cold).thermal is None
    )
    assert "thermal" not in cold.resolved() and "thermal" not in parse(warm()).absent_effects()


def test_hashes():
    """Without [thermal] an expansion changes no result, and walls are found for one of each field;
    with it every number counts."""
    expanding = small()
    expanding["rail"]["material"]["expansion"] = EXPANSION
    cold, other, found = parse(small()), parse(expanding), parse(warm())
    assert cold.hash == other.hash != found.hash
    assert digest(cold) == digest(other) == digest(found)
    changed = {
        "thermal.mean": 21.0,
        "thermal.gradient.x": 1.0,
        "thermal.platform_strain": 1e-5,
        "rail.material.expansion": 2e-5,
    }
    assert (
        len({found.hash, *(found.replace({key: value}).hash for key, value in changed.items())})
        == 5
    )


def test_what_was_written_is_read_back():
    found = parse(warm(mean="20 K", gradient={"y": "0.1 K/mm"}))
    assert parse(found.resolved(), bare_numbers_are_si=True).hash == found.hash


def test_slips_of_units_are_warned_about():
    assert not any("expan" in words for words in parse(warm(mean="60 K")).warnings)
    assert any(
        "rail.material.expansion" in words
        for words in parse(warm(expansion="23.6e-3 1/K", mean="1 mK")).warnings
    )
    assert any(
        words.startswith("thermal") for words in parse(warm(gradient={"x": "20 K/mm"})).warnings
    )


def test_reference_rails_can_be_warmed():
    found = load("reference").replace({"thermal.mean": "20 K"})
    assert found.thermal.record(found.rail).amounts[0] == pytest.approx(4.72e-4)
