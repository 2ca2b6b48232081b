"""How tests of the evidence treat figures: as those of studies do."""

from tests.studies.conftest import figures

__all__ = ["figures"]
