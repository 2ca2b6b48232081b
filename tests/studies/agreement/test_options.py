"""The number of neighbours that the agreement study takes."""

import pytest

from tipoff.scenes import load
from tipoff.studies.agreement import stage
from tipoff.studies.agreement.options import Options
from tipoff.workspace.settings import defaults
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study


@pytest.mark.parametrize(
    "stored, given, taken",
    [(None, None, 5), (128, None, 5), (128, 64, 64), (None, 64, 64)],
)
def test_the_number_is_that_asked_for_or_of_the_settings(
    tmp_path, monkeypatch, stored, given, taken
):
    """Whatever is stored. Control: the page shows what is stored, and makes the rest."""
    study = Study(load("tiny"), tmp_path, defaults("tiny"))
    found = None if stored is None else {"asked": {"neighbours": stored}}
    monkeypatch.setattr(stage, "candidates", lambda _: (None,) * 4)
    monkeypatch.setattr(Stage, "stored", lambda *_: found)
    monkeypatch.setattr(Stage, "run", lambda own, _, options, make: own.plain(options))
    options = None if given is None else Options(given)
    assert stage.run(study, options) == {"neighbours": taken}
    assert stage.current(study) == {"neighbours": stored or 5}
