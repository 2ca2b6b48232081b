"""Stage ``compare``: agreement of the surrogates with the reference on fitted and held-out
conditions, as curves or as distributions, with the floor and the uncertainty of the reference; growth
of a 1 um disturbance; speed-up."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.studies.agreement import distributions, growth, interface, metrics, refined, verdicts
from tipoff.studies.agreement.verdicts import Context, Spread, spread
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.core.progress import Board
from tipoff.studies.core.settings import Settings
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.store import Run, with_modes_of
from tipoff.studies.core.study import Study, require_success
from tipoff.studies.cost.timing import speedups

_SIMPLER = {
    "mean pressure of each face by itself": (1, False),
    "mean pressure": (1, True),
    "pressure and its tilt": (3, True),
    "all, each face by itself": (PATTERNS, False),
}


class Candidate(NamedTuple):
    """A surrogate to compare with the reference: ``name`` in result files, ``title`` in the report,
    ``calibration`` of its springs, rail ``compliance`` by condition, ``modes`` of each rail."""

    name: str
    title: str
    calibration: Calibration | None = None
    compliance: Mapping[str, RailCompliance | None] = MappingProxyType({})
    modes: int = 0

    def request(
        self, study: Study, condition: str, overrides: dict | None = None, tag: str = "", **numerics
    ) -> Run:
        """The run of a condition with ``overrides`` of the scene; ``tag`` is part of its name."""
        modes = {"modes": self.modes} if self.modes else {}
        return study.lowfi(
            condition,
            self.calibration,
            overrides,
            tag + "-modal" * bool(self.modes),
            self.compliance.get(condition),
            **modes,
            **numerics,
        )


def candidates(study: Study, conditions: Iterable[str] | None = None) -> list[Candidate]:
    """The surrogates of a scene for ``conditions`` (default: all): springs with the constants of the
    scene, springs with calibrated constants, compliant contact, and compliant contact with the
    lowest modes of the rails."""
    static, modes = (
        compliant(study, study.conditions if conditions is None else conditions),
        study.settings.rail_modes,
    )
    return [
        Candidate("uncalibrated", f"{SPRINGS}, uncalibrated"),
        Candidate("calibrated", f"{SPRINGS}, calibrated", calibrate.load(study)),
        static,
        static._replace(name="modal", title=f"{COMPLIANT}, {modes} modes", modes=modes),
    ]


def compliant(study: Study, conditions: Iterable[str]) -> Candidate:
    """The surrogate on compliant contact, for ``conditions``."""
    return Candidate("compliant", COMPLIANT, compliance=study.rail_compliances(conditions))


@dataclass(frozen=True)
class Options:
    """``neighbours`` of each condition that is judged as a distribution."""

    neighbours: int = Settings().neighbours


def run(study: Study, options: Options | None = None) -> dict:
    """``uncalibrated``, ``fitted``, ``held_out``, ``compliant`` and ``modal`` rows; measured
    ``floor`` and ``refinement``; ``growth`` of a 1 um disturbance; ``distributions`` of conditions
    that no single run can judge; ``speedup`` of calibrated springs and ``speedup_compliant``;
    ``simpler`` rail compliance; other values of the ``interface`` stiffness. ``options`` None: those
    of the stored result, or else of the settings."""
    study.fitted()
    chosen = options or _last(study)
    _, calibrated, static, modal = compared = candidates(study)
    gates = verdicts.gates(study.scene)

    def make() -> tuple[dict, list[Path]]:
        wanted = {name: study.highfi(name) for name in study.conditions}
        highfi = dict(zip(wanted, study.store.fill("highfi", list(wanted.values()))))
        require_success(highfi, "compare")
        changes, floor = refined.refinements(study), floors(study, "reference", study.coarse)
        own = {
            candidate.name: floors(study, candidate.title, partial(candidate.request, study))
            for candidate in compared
        }
        table = {
            candidate.name: rows(
                study, candidate, highfi, Context([*floor, *own[candidate.name]], changes, gates)
            )
            for candidate in compared
        }
        on_coarse = _on_coarse(study, compared)
        own_context = Context([*floor, *own[static.name]], changes, gates)
        stiffnesses = interface.rows(study, on_coarse[static.name].request, own_context)
        grown = _growths(study, static, table["compliant"])
        wanted_alike = distributions.counts(
            table["compliant"], grown, interface.chaotic(stiffnesses), chosen.neighbours
        )
        alike = distributions.judge(
            study, wanted_alike, list(on_coarse.values()), gates["settled_rate_error_deg_s"]
        )
        table = {
            name: distributions.combined(found, alike, wanted_alike, name)
            for name, found in table.items()
        }
        table["compliant"] = interface.combined(table["compliant"], stiffnesses)
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
            "rail_modes": modal.modes,
            "gates": gates,
            "element_size_m": study.settings.element_size,
            "converged_deg_s": verdicts.CONVERGED_DEG_S,
            "clearance_change_m": study.settings.clearance_change,
            "floor": [asdict(item) for item in sum(own.values(), floor)],
            "refinement": [asdict(item) for item in changes],
            "growth": [asdict(item) for item in grown],
            "distributions": alike,
            "simpler": _simpler(study, static, highfi),
            "interface": stiffnesses,
            **dict(zip(("speedup", "speedup_compliant"), _speedups(study, [calibrated, static]))),
        }, []

    return STAGE.run(study, chosen, make)


def _last(study: Study) -> Options:
    found = STAGE.stored(study)
    return Options(**found["asked"]) if found is not None else Options(study.settings.neighbours)


def _on_coarse(study: Study, compared: Iterable[Candidate]) -> dict[str, Candidate]:
    """The same surrogates by name, on the rail compliance of the coarse mesh."""
    coarse = study.rail_compliances(study.conditions, study.settings.coarse_size)
    return {
        candidate.name: candidate._replace(compliance=coarse) if candidate.compliance else candidate
        for candidate in compared
    }


def _inputs(study: Study, _: Options) -> list:
    return [calibrate.constants(study), verdicts.gates(study.scene)]


STAGE = Stage("agreement", __name__, Options, inputs=_inputs)
stored = STAGE.stored


def rows(
    study: Study, candidate: Candidate, highfi: dict[str, Trajectory], context: Context
) -> list[dict]:
    """Agreement of one surrogate on every condition."""
    wanted = {name: candidate.request(study, name) for name in study.conditions}
    found = dict(zip(wanted, study.store.fill(candidate.title, list(wanted.values()))))
    return [
        verdicts.row(name, role, highfi[name], found[name], context)
        for role in ("fitted", "held_out")
        for name in getattr(study.scene.agreement, role)
    ]


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


def floors(study: Study, model: str, request: Callable[..., Run]) -> list[Spread]:
    """Spread of one model under +-1 um of clearance, on the scene's conditions of the floor;
    ``request`` makes its runs."""
    if study.scene.contact is None:
        return []
    return [
        spread(name, model, "clearance", nominal, changed)
        for name, (nominal, *changed) in _twins(
            study, f"floor, {model}", request, study.scene.agreement.floor
        ).items()
    ]


def _growths(study: Study, compliant: Candidate, rows: list[dict]) -> list[growth.Growth]:
    """Growth of 1 um of clearance in both models, on the conditions of the floor and on those whose
    reference is not converged, because chaos can be the reason."""
    if study.scene.contact is None:
        return []
    names = dict.fromkeys(
        [
            *study.scene.agreement.floor,
            *(row["condition"] for row in rows if not row["reference_converged"]),
        ]
    )
    gate = verdicts.gates(study.scene)["settled_rate_error_deg_s"]
    return [
        growth.growth(name, model, nominal, changed, study.settings.clearance_change, gate)
        for model, request in (
            (FINITE_ELEMENTS, study.coarse),
            (compliant.title, partial(compliant.request, study)),
        )
        for name, (nominal, *changed) in _twins(study, f"growth, {model}", request, names).items()
    ]


def _twins(
    study: Study, title: str, request: Callable[..., Run], names: Iterable[str]
) -> dict[str, list[Trajectory]]:
    """The run of each condition, and its runs with 1 um more and less clearance."""
    names, changes = list(names), clearances(study)
    nominal = dict(zip(names, study.store.fill(title, [request(name) for name in names])))
    changed = study.store.fill(
        title,
        [
            with_modes_of(nominal[name], request(name, overrides=change, tag=f"-clearance-{sign}"))
            for name in names
            for sign, change in changes.items()
        ],
    )
    runs = iter(changed)
    return {name: [nominal[name], *(next(runs) for _ in changes)] for name in names}


def clearances(study: Study) -> dict[str, dict[str, float]]:
    """Overrides of a scene with contact that perturb its clearance."""
    assert study.scene.contact is not None
    return study.scene.contact.either_way(study.settings.clearance_change)


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
