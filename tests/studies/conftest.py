"""How tests of studies treat figures and runs."""

import pytest

from tests.studies.synthetic import COSTS, flight, undrawn
from tipoff.workspace import store


@pytest.fixture(params=["laid out", pytest.param("drawn", marks=pytest.mark.slow)])
def figures(request, monkeypatch):
    """Figures are laid out alone, which shows most faults; in a slow test they are drawn."""
    if request.param == "laid out":
        undrawn(monkeypatch, laid_out=True)


@pytest.fixture
def stub(monkeypatch):
    """``stub(**parts)``: every run is a flight with these parts."""

    def put(**parts):
        monkeypatch.setattr(store, "prepare", lambda run: None)
        monkeypatch.setattr(
            store,
            "execute",
            lambda run, *rest, **kept: flight(model=run.model, cost=COSTS, **parts),
        )

    return put
