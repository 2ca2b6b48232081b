"""How tests of studies treat figures."""

import pytest

from tests.studies.synthetic import undrawn


@pytest.fixture(params=["laid out", pytest.param("drawn", marks=pytest.mark.slow)])
def figures(request, monkeypatch):
    """Figures are laid out alone, which shows most faults; in a slow test they are drawn."""
    if request.param == "laid out":
        undrawn(monkeypatch, laid_out=True)
