"""Stage ``compare``: agreement of the surrogates with the reference on fitted and held-out
conditions, as curves or as distributions, with the floor and the uncertainty of the reference; growth
of a 1 um disturbance; speed-up."""

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from tipoff.comparison import metrics
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import interface, judging, verdicts
from tipoff.studies.agreement.candidates import Candidate, candidates, on_coarse
from tipoff.studies.agreement.distributions import Distribution
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.agreement.options import CompareOptions
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study
from tipoff.workspace.timing import Speedup, speedups

NEIGHBOURS_OF_A_REPORT = 8
_SIMPLER = {
    "mean pressure of each face by itself": (1, False),
    "mean pressure": (1, True),
    "pressure and its tilt": (3, True),
    "all, each face by itself": (PATTERNS, False),
}


@dataclass(frozen=True, kw_only=True)
class Simpler:
    """Errors of compliant contact with a part of the rail compliance, ``walls`` in words: the first
    pressure ``patterns`` of each face, ``coupled`` between faces or not; None if a run did not
    settle."""

    walls: str
    patterns: int
    coupled: bool
    condition: str
    rate_relative_l2: verdicts.RateL2
    settled_rate_error_deg_s: verdicts.SettledError


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """Rows of the agreement table by surrogate, of calibrated springs ``fitted`` and ``held_out``;
    ``rail_compliance``, the elements of the most uncertain one and their uncertainty, None where not
    known; ``rail_modes`` of the rows ``modal``; measured ``floor`` and ``refinement``; ``growth`` of a
    1 um disturbance; ``distributions`` of conditions that no single run can judge; ``simpler`` rail
    compliance; other values of the ``interface`` stiffness; ``speedup`` of calibrated springs and of
    compliant contact."""

    uncalibrated: tuple[JudgedCondition, ...]
    fitted: tuple[JudgedCondition, ...]
    held_out: tuple[JudgedCondition, ...]
    compliant: tuple[JudgedCondition, ...]
    modal: tuple[JudgedCondition, ...]
    rail_compliance: dict[str, Any] | None
    rail_modes: int
    gates: verdicts.Gates
    element_size_m: float
    converged_deg_s: float
    clearance_change_m: float
    floor: tuple[verdicts.Spread, ...]
    refinement: tuple[verdicts.Refinement, ...]
    growth: tuple[Growth, ...]
    distributions: tuple[Distribution, ...]
    simpler: tuple[Simpler, ...]
    interface: tuple[interface.AtStiffness, ...]
    speedup: Speedup
    speedup_compliant: Speedup

    @property
    def calibrated(self) -> tuple[JudgedCondition, ...]:
        """Rows of calibrated springs, fitted ones first."""
        return self.fitted + self.held_out


def run(study: Study, options: CompareOptions | None = None) -> Made[Agreement]:
    """Judge the surrogates; default ``options``: those of the settings."""
    study.fitted()
    draws = (options and options.neighbours) or study.settings.neighbours
    _, calibrated, static, modal = compared = candidates(study)

    def make() -> tuple[Agreement, list[Path]]:
        curves = judging.as_curves(study, compared, "compare")
        stiffnesses = interface.rows(
            study, on_coarse(study, compared)[static.name].request, curves.contexts[static.name]
        )
        found = judging.judge(study, compared, curves, draws, interface.undecided(stiffnesses))
        springs = found.rows[calibrated.name]
        speeds = _speedups(study, [calibrated, static])
        return Agreement(
            uncalibrated=tuple(found.rows["uncalibrated"]),
            fitted=tuple(row for row in springs if row.role == "fitted"),
            held_out=tuple(row for row in springs if row.role == "held_out"),
            compliant=tuple(interface.combined(found.rows[static.name], stiffnesses)),
            modal=tuple(found.rows[modal.name]),
            rail_compliance=_elements(static),
            rail_modes=study.settings.rail_modes,
            gates=verdicts.gates(study.scene),
            element_size_m=study.settings.element_size,
            converged_deg_s=verdicts.CONVERGED_DEG_S,
            clearance_change_m=study.settings.clearance_change,
            floor=tuple(curves.floors),
            refinement=tuple(curves.refinements),
            growth=tuple(found.growths),
            distributions=tuple(found.distributions),
            simpler=tuple(_simpler(study, static, curves.reference)),
            interface=tuple(stiffnesses),
            speedup=speeds[calibrated.name],
            speedup_compliant=speeds[static.name],
        ), []

    return STAGE.run(study, CompareOptions(neighbours=draws), make)


def current(study: Study) -> Made[Agreement]:
    """The result for the page: the stored one of ``tipoff compare``, with its number of neighbours,
    if scene, code and settings are the present ones; otherwise a new one with few neighbours, whose
    runs take most of the time of a first report."""
    found = STAGE.stored(study)
    few = CompareOptions(neighbours=min(NEIGHBOURS_OF_A_REPORT, study.settings.neighbours))
    return run(study, few if found is None else STAGE.asked(found.document))


def _elements(compliant: Candidate) -> dict | None:
    """The statement of the most uncertain rail compliance about its elements."""
    found = [under.stated() for under in compliant.compliance.values() if under is not None]
    known = [own for own in found if own is not None]
    return max(known, key=lambda own: own["uncertainty"] or 0.0, default=None)


def _inputs(study: Study, _: CompareOptions) -> list:
    return [calibrate.constants(study), asdict(verdicts.gates(study.scene))]


STAGE = Stage("agreement", __name__, options=CompareOptions, inputs=_inputs, result=Agreement)


def stored(study: Study) -> Agreement | None:
    """The stored result if it was made from the present scene, code and settings."""
    found = STAGE.stored(study)
    return None if found is None else found.result


def _simpler(study: Study, compliant: Candidate, highfi: dict[str, Trajectory]) -> list[Simpler]:
    """Errors of surrogates with parts of the rail compliance."""
    found = []
    for words, (patterns, coupled) in _SIMPLER.items():
        candidate = compliant._replace(
            compliance={
                name: whole and whole.restricted(patterns, coupled)
                for name, whole in compliant.compliance.items()
            }
        )
        wanted = [
            candidate.request(study, name, tag=f"-{patterns}{'' if coupled else '-apart'}")
            for name in study.conditions
        ]
        for name, result in zip(study.conditions, study.store.fill(f"walls: {words}", wanted)):
            difference = metrics.compare(highfi[name], result)
            found.append(
                Simpler(
                    walls=words,
                    patterns=patterns,
                    coupled=coupled,
                    condition=name,
                    rate_relative_l2=difference.rate_relative_l2,
                    settled_rate_error_deg_s=difference.settled_rate_error_deg_s,
                )
            )
    return found


def _speedups(study: Study, compared: list[Candidate]) -> dict[str, Speedup]:
    name, settings = study.fitted()[0], study.settings
    with Board("speed-up", 1) as board:
        found = speedups(
            study.highfi(name),
            {candidate.name: candidate.request(study, name) for candidate in compared},
            settings.highfi_repeats,
            settings.lowfi_repeats,
            board.callback("speed-up"),
        )
        ratios = " and ".join(f"{item.ratio:,.0f} times" for item in found.values())
        board.finished("speed-up", ratios)
    return {key: replace(item, condition=name) for key, item in found.items()}
