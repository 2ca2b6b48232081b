"""The number of neighbours that the agreement study takes."""

import pytest

from tipoff.scenes import load
from tipoff.studies.agreement import stage
from tipoff.studies.core.settings import defaults
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.study import Study


@pytest.mark.parametrize(
    "stored, given, taken",
    [(None, None, 5), (128, None, 128), (128, 64, 64), (None, 64, 64)],
)
def test_a_report_keeps_the_number_that_a_command_asked_for(
    tmp_path, monkeypatch, stored, given, taken
):
    """Without one, that of the settings."""
    study = Study(load("tiny"), tmp_path, defaults("tiny"))
    found = None if stored is None else {"asked": {"neighbours": stored}}
    monkeypatch.setattr(stage, "candidates", lambda _: (None,) * 4)
    monkeypatch.setattr(Stage, "stored", lambda *_: found)
    monkeypatch.setattr(Stage, "run", lambda own, _, options, make: own.plain(options))
    options = None if given is None else stage.Options(given)
    assert stage.run(study, options) == {"neighbours": taken}
