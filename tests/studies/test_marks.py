"""Which cases are outside a calibration is kept beside their results, one by one."""

from dataclasses import replace

import numpy as np
import pytest

from lowfi import store as stores
from lowfi.rows import Listed
from lowfi.store import StoreError
from scenes import validity
from studies.populations import marks, population
from studies.populations.population import Surrogate
from studies.settings import Settings
from studies.study import Study, StudyError
from tests.studies.test_population import FITTED, ROWS, SCENE

zarr = pytest.importorskip("zarr")
FLAGS = [False, False, True, True, True, False]  # of ROWS


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return Study(SCENE, tmp_path_factory.mktemp("out"), Settings(workers=1))


def marked(study, fitted=FITTED):
    """The population of ROWS on constants that are ``fitted``, and what its store says of its cases."""
    found = population.run(study, "marked", Surrogate(SCENE, fitted, None), Listed(ROWS))
    return found, marks.kept(study.path(found.store))


def test_marks_lie_beside_the_results_and_say_by_what(study):
    found, kept = marked(study)
    assert kept.outside.tolist() == found.outside.tolist() == FLAGS and kept.outside.dtype == bool
    assert kept.judged_by == {"ranges_si": FITTED.valid, "margin": validity.MARGIN, "geometry_hash": SCENE.geometry_hash}
    array = zarr.open_group(study.path(found.store) / "cases.zarr", mode="r")[marks.NAME]
    assert array.attrs["long_name"].startswith("whether a case lies outside") and array.metadata.dimension_names == ("case",)


def test_another_calibration_judges_the_same_cases_anew_and_runs_none_again(study, monkeypatch):
    """Control: with nothing changed no file of the marks is written again."""
    first, _ = marked(study)
    chunks = study.path(first.store) / "cases.zarr" / marks.NAME
    monkeypatch.setattr("lowfi.fill.completed", lambda *_: pytest.fail("ran a stored case again"))
    written = {path: path.stat().st_mtime_ns for path in chunks.rglob("*") if path.is_file()}
    marked(study)
    assert {path: path.stat().st_mtime_ns for path in chunks.rglob("*") if path.is_file()} == written
    for fitted, flags in ((replace(FITTED, valid={}), [False] * 6), (None, [False] * 6), (FITTED, FLAGS)):
        found, kept = marked(study, fitted)
        assert found.store == first.store and kept.outside.tolist() == flags
        assert (kept.judged_by is None) == (fitted is None)
        assert np.array_equal(found.results.rate, first.results.rate)


def test_a_store_is_whole_with_marks_and_without_and_goes_on_where_it_stopped(study, monkeypatch):
    """The digest of its numbers does not know of them; a chunk that is lost is run again beside them, to the same bits."""
    opened, make = [], stores.Store.__init__
    monkeypatch.setattr(stores.Store, "__init__", lambda self, *given: (opened.append(self), make(self, *given))[1])
    first, _ = marked(study)
    digest = opened[-1].digest()
    (study.path(first.store) / "done" / "000000.json").unlink()
    assert opened[-1].pending() == [0]
    again, kept = marked(study)
    assert opened[-1].pending() == [] and opened[-1].digest() == digest and kept.outside.tolist() == FLAGS
    assert np.array_equal(again.results.rate, first.results.rate)


@pytest.mark.parametrize("harm", ["half written", "gone", "damaged"])
def test_marks_that_are_not_whole_are_refused_and_written_again(study, harm):
    found, _ = marked(study)
    path = study.path(found.store)
    group = zarr.open_group(path / "cases.zarr", mode="r+")
    if harm == "half written":
        group[marks.NAME][:] = False  # as a kill between the attributes and the values leaves it
    elif harm == "gone":
        del group[marks.NAME]
    else:
        chunk, = (item for item in (path / "cases.zarr" / marks.NAME / "c").rglob("*") if item.is_file())
        chunk.write_bytes(b"\0")
    with pytest.raises(StoreError, match="says of no case"):
        marks.kept(path)
    assert marked(study)[1].outside.tolist() == FLAGS


def test_marks_that_cannot_be_written_are_a_study_s_fault_in_words(study, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    marked(study)
    monkeypatch.setattr(zarr.Group, "create_array", full)
    with pytest.raises(StudyError, match="No space left on device"):
        marked(study, replace(FITTED, valid={}))
