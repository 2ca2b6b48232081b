"""Stage ``compare``: agreement of the surrogates with the reference on fitted and held-out
conditions, as curves or as distributions, with the floor and the uncertainty of the reference; growth
of a 1 um disturbance; speed-up."""

from dataclasses import asdict, dataclass
from pathlib import Path

from tipoff.comparison import metrics
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.agreement import interface, judging, verdicts
from tipoff.studies.agreement.candidates import Candidate, candidates, on_coarse
from tipoff.studies.calibration import stage as calibrate
from tipoff.workspace.progress import Board
from tipoff.workspace.settings import Settings
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study
from tipoff.workspace.timing import speedups

_SIMPLER = {
    "mean pressure of each face by itself": (1, False),
    "mean pressure": (1, True),
    "pressure and its tilt": (3, True),
    "all, each face by itself": (PATTERNS, False),
}


@dataclass(frozen=True)
class Options:
    """``neighbours`` of each condition that is judged as a distribution."""

    neighbours: int = Settings().neighbours


def run(study: Study, options: Options | None = None) -> dict:
    """``uncalibrated``, ``fitted``, ``held_out``, ``compliant`` and ``modal`` rows; measured
    ``floor`` and ``refinement``; ``growth`` of a 1 um disturbance; ``distributions`` of conditions
    that no single run can judge; ``speedup`` of calibrated springs and ``speedup_compliant``;
    ``simpler`` rail compliance; ``rail_compliance``, its elements and their uncertainty; other
    values of the ``interface`` stiffness. ``options`` None: those of the settings."""
    study.fitted()
    chosen = options or Options(study.settings.neighbours)
    _, calibrated, static, modal = compared = candidates(study)

    def make() -> tuple[dict, list[Path]]:
        curves = judging.as_curves(study, compared, "compare")
        stiffnesses = interface.rows(
            study, on_coarse(study, compared)[static.name].request, curves.contexts[static.name]
        )
        found = judging.judge(
            study, compared, curves, chosen.neighbours, interface.undecided(stiffnesses)
        )
        table = found.rows | {static.name: interface.combined(found.rows[static.name], stiffnesses)}
        groups = {
            role: [row for row in table["calibrated"] if row["role"] == role]
            for role in ("fitted", "held_out")
        }
        return {
            "asked": STAGE.plain(chosen),
            "uncalibrated": table["uncalibrated"],
            **groups,
            "compliant": table["compliant"],
            "modal": table["modal"],
            "rail_compliance": _elements(static),
            "rail_modes": modal.modes,
            "gates": verdicts.gates(study.scene),
            "element_size_m": study.settings.element_size,
            "converged_deg_s": verdicts.CONVERGED_DEG_S,
            "clearance_change_m": study.settings.clearance_change,
            "floor": [asdict(item) for item in curves.floors],
            "refinement": [asdict(item) for item in curves.refinements],
            "growth": [asdict(item) for item in found.growths],
            "distributions": found.distributions,
            "simpler": _simpler(study, static, curves.reference),
            "interface": stiffnesses,
            **dict(zip(("speedup", "speedup_compliant"), _speedups(study, [calibrated, static]))),
        }, []

    return STAGE.run(study, chosen, make)


def current(study: Study) -> dict:
    """The result that the page shows: that of the last ``tipoff compare`` if it is of the present scene,
    code and settings, with its number of neighbours, else a new one."""
    found = STAGE.stored(study)
    return run(study, None if found is None else STAGE.asked(found))


def _elements(compliant: Candidate) -> dict | None:
    """What the most uncertain rail compliance states about its elements."""
    found = [under.stated() for under in compliant.compliance.values() if under is not None]
    known = [own for own in found if own is not None]
    return max(known, key=lambda own: own["uncertainty"] or 0.0, default=None)


def _inputs(study: Study, _: Options) -> list:
    return [calibrate.constants(study), verdicts.gates(study.scene)]


STAGE = Stage("agreement", __name__, Options, inputs=_inputs)
stored = STAGE.stored


def _simpler(study: Study, compliant: Candidate, highfi: dict[str, Trajectory]) -> list[dict]:
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
                {
                    "walls": words,
                    "patterns": patterns,
                    "coupled": coupled,
                    "condition": name,
                    "rate_relative_l2": difference.rate_relative_l2,
                    "settled_rate_error_deg_s": difference.settled_rate_error_deg_s,
                }
            )
    return found


def _speedups(study: Study, compared: list[Candidate]) -> list[dict]:
    name, settings = study.fitted()[0], study.settings
    with Board("speed-up", 1) as board:
        found = speedups(
            study.highfi(name),
            {candidate.name: candidate.request(study, name) for candidate in compared},
            settings.highfi_repeats,
            settings.lowfi_repeats,
            board.callback("speed-up"),
        )
        board.finished(
            "speed-up", " and ".join(f"{item['ratio']:,.0f} times" for item in found.values())
        )
    return [item | {"condition": name} for item in found.values()]
