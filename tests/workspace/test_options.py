"""Options of studies: rules and flags; results as CSV."""

from dataclasses import dataclass
from typing import Annotated

import pytest
import typer

from tipoff import scenes
from tipoff.calibration import rail_compliance
from tipoff.faults import SceneError
from tipoff.highfi import compliance as statics
from tipoff.mechanics.rail_compliance import MODES
from tipoff.scenes import studies
from tipoff.workspace import settings
from tipoff.workspace.options import between, require
from tipoff.workspace.stage import csv_of


@dataclass(frozen=True)
class Inner:
    axial: Annotated[float, between(below=2.0), typer.Option("--reading")] = 1.0


@dataclass(frozen=True)
class Options:
    limits: Annotated[tuple[str, ...], typer.Option("--limit")] = ("x=2 deg/s",)
    share: Annotated[float, between(0.5, below=1.0)] = 0.9
    runs: Annotated[int | None, between(20, noun="runs"), typer.Option(metavar="N")] = None
    case_count: Annotated[int, between(1, 1000)] = 10
    inner: Inner = Inner()


def test_every_broken_rule_is_a_fault_under_its_flag():
    """Control: options on their bounds."""
    require(Options(share=0.5, runs=20, case_count=1000))
    with pytest.raises(SceneError) as refused:
        require(Options(share=1.0, runs=19, case_count=0, inner=Inner(2.0)))
    assert list(map(str, refused.value.faults)) == [
        "--share: value: given 1.0, expected 0.5 or more and less than 1",
        "--runs: value: given 19, expected 20 or more runs",
        "--case-count: value: given 0, expected 1 to 1,000",
        "--reading: value: given 2.0, expected less than 2",
    ]


def test_an_option_of_another_type_is_a_fault():
    with pytest.raises(SceneError, match="--limit: value"):
        require(Options(limits=3))


def test_rows_with_fewer_numbers_leave_the_last_columns_empty():
    """Control: what follows stands below its own head."""
    rows = [{"sizes": [4.0], "method": "one"}, {"sizes": [4.0, 2.0], "method": "two"}]
    assert csv_of(rows) == "sizes_1,sizes_2,method\n4.0,,one\n4.0,2.0,two\n"


def test_a_table_has_a_column_for_each_number():
    """Three numbers are axes, words stand in one cell, and a missing value in none."""
    rows = [
        {"name": "a, b", "rate_deg_s": [1.0, -2.5e-7, 0.1], "both": [1, 2], "words": ["p", "q"]},
        {"name": "c", "rate_deg_s": None, "both": [3, 4], "words": []},
    ]
    assert csv_of(rows) == (
        "name,rate_deg_s_x,rate_deg_s_y,rate_deg_s_z,both_1,both_2,words\n"
        '"a, b",1.0,-2.5e-07,0.1,1,2,p q\n'
        "c,,,,3,4,\n"
    )


def test_a_record_in_a_row_has_its_own_columns_and_a_curve_none():
    """Also where another row lacks the record. Control: as many numbers as fit are columns."""
    record = {"x_m": 1.0, "inner": {"y_m": 2.0}, "curve": list(range(13)), "both": [3, 4]}
    rows = [{"name": "a", "of": record, "matrix": [[1.0]]}, {"name": "b", "of": None, "matrix": []}]
    assert csv_of(rows) == "name,of_x_m,of_inner_y_m,of_both_1,of_both_2\na,1.0,2.0,3,4\nb,,,,\n"


def test_a_scene_states_the_modes_of_the_compared_surrogate():
    """As many as a rail compliance has at most. Control: four by default."""
    assert settings.defaults("tiny").rail_modes == 4
    scene = scenes.load("tiny")
    assert settings.defaults(scene.replace({"studies.rail_modes": MODES})).rail_modes == MODES
    with pytest.raises(SceneError, match="studies.rail_modes"):
        scene.replace({"studies.rail_modes": MODES + 1})


def test_elements_grow_with_the_rail_unless_the_scene_states_them(tmp_path):
    """All rails of the catalogue are too short for that. The message on a long rail says why; control:
    with a stated size it does not."""
    for name in scenes.catalog():
        own, found = scenes.load(name), settings.defaults(name).element_size
        stated = own.studies and own.studies.element_size
        assert found == (stated or 2e-3) and studies.usual_size(own.rail.length) == 2e-3

    def said(scene) -> str:
        lines: list[str] = []
        with pytest.MonkeyPatch.context() as patch, pytest.raises(MemoryError):
            patch.setattr(statics, "rails", full)
            rail_compliance.kept(
                scene, tmp_path, settings.defaults(scene).element_size, lines.append
            )
        return lines[0]

    def full(*_given):
        raise MemoryError

    stated = scenes.load("rocket_rail").replace({"rail.end": 10.28})
    assert settings.defaults(stated).element_size == 5e-3
    assert "5 mm elements; takes" in said(stated)
    for end, size in ((1.37, 2e-3), (3.27, 10e-3), (10.28, 20e-3)):
        scene = stated.replace({"rail.end": end, "studies.element_size": None})
        assert settings.defaults(scene).element_size == size
    assert "20 mm elements (the default for a rail of 11 m); takes" in said(scene)
