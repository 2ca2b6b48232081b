"""The surrogates that are compared with the reference."""

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from tipoff.lowfi.numerics import AUTO
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.mechanics.rail_compliance import RailCompliance
from tipoff.scenes.calibration import Calibration
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

_TAGS = {AUTO: "", 0: "-static"}  # in names of files; any other number of modes is "-modal"


class Candidate(NamedTuple):
    """A surrogate to compare with the reference: ``name`` in result files, ``title`` in the report,
    ``calibration`` of its springs, rail ``compliance`` by condition, ``modes`` of each rail as in
    ``lowfi.Numerics``."""

    name: str
    title: str
    calibration: Calibration | None = None
    compliance: Mapping[str, RailCompliance | None] = MappingProxyType({})
    modes: int | str = AUTO

    def request(
        self, study: Study, condition: str, overrides: dict | None = None, tag: str = "", **numerics
    ) -> Run:
        """The run of a condition with ``overrides`` of the scene; ``tag`` is part of its name."""
        return study.lowfi(
            condition,
            self.calibration,
            overrides,
            tag + _TAGS.get(self.modes, "-modal"),
            self.compliance.get(condition),
            modes=self.modes,
            **numerics,
        )


def candidates(study: Study, conditions: Iterable[str] | None = None) -> list[Candidate]:
    """The surrogates of a scene for ``conditions`` (default: all): springs with the constants of the
    scene, springs with calibrated constants, compliant contact, and compliant contact with a fixed
    number of the lowest modes of the rails."""
    static, modes = (
        compliant(study, study.conditions if conditions is None else conditions),
        study.settings.rail_modes,
    )
    return [
        Candidate("uncalibrated", f"{SPRINGS}, uncalibrated"),
        calibrated(study),
        static,
        static._replace(name="modal", title=f"{COMPLIANT}, {modes} modes", modes=modes),
    ]


def calibrated(study: Study) -> Candidate:
    """The springs with the calibrated constants of a scene."""
    return Candidate("calibrated", f"{SPRINGS}, calibrated", calibrate.load(study))


def compliant(study: Study, conditions: Iterable[str]) -> Candidate:
    """The surrogate on compliant contact, for ``conditions``."""
    return Candidate(COMPLIANT, COMPLIANT, compliance=study.rail_compliances(conditions))


def on_coarse(study: Study, compared: Iterable[Candidate]) -> dict[str, Candidate]:
    """The surrogates ``compared`` by name, on the rail compliance of the coarse mesh."""
    coarse = study.rail_compliances(study.conditions, study.settings.coarse_size)
    return {
        candidate.name: candidate._replace(compliance=coarse) if candidate.compliance else candidate
        for candidate in compared
    }
