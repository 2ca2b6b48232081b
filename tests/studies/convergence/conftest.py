"""The convergence study on stubbed runs."""

from typing import ClassVar

import pytest

from tests.studies.convergence import stub
from tests.studies.synthetic import kept_in_memory
from tipoff import scenes
from tipoff.studies.convergence import stage as convergence
from tipoff.workspace import store as store_module
from tipoff.workspace import timing
from tipoff.workspace.settings import defaults
from tipoff.workspace.study import Study


class Labels(list):
    """Labels of the runs that were made, in order; ``failing`` maps a label to what became of it
    instead."""

    failing: ClassVar[dict[str, str]] = {}


def _stubbed(monkeypatch) -> Labels:
    made = Labels()

    def execute(run, progress=None, threads=None, **kept):
        made.append(run.label)
        return stub.motion(run, status=made.failing.get(run.label, "exited"))

    monkeypatch.setattr(store_module, "execute", execute)
    monkeypatch.setattr(store_module, "prepare", lambda run: None)
    monkeypatch.setattr(timing, "warm_up", lambda run: None)
    monkeypatch.setattr(timing, "execute", lambda run, progress=None: stub.motion(run))
    monkeypatch.setattr(Study, "rail_compliances", lambda study, names: dict.fromkeys(names))
    monkeypatch.setattr(convergence.statics, "quantities", stub.resting)
    return made


@pytest.fixture
def asked(monkeypatch):
    """``Labels`` of the stubbed runs, which are kept in memory."""
    kept_in_memory(monkeypatch)
    return _stubbed(monkeypatch)


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A study with all its files, and what it found, which no test changes."""
    with pytest.MonkeyPatch.context() as patch:
        kept_in_memory(patch)
        _stubbed(patch)
        made = Study(scenes.load("tiny"), tmp_path_factory.mktemp("tiny"), defaults("tiny"))
        return made, convergence.run(made)


@pytest.fixture
def study(tmp_path, asked):
    return Study(scenes.load("tiny"), tmp_path / "tiny", defaults("tiny"))
