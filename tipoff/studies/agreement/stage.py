"""Stage ``compare``: agreement of the surrogates with the reference, on conditions one was fitted
to and on conditions none ever saw, beside the floor and the uncertainty of the reference; the
growth of 1 um; and the speed-up."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS, SPRINGS
from tipoff.mechanics.rail_compliance import PATTERNS, RailCompliance
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.calibration import Calibration
from tipoff.studies.agreement import growth, metrics, verdicts
from tipoff.studies.agreement.verdicts import Context, Spread, spread
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.core.progress import Board
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study, require_success
from tipoff.studies.cost.timing import speedups

_SIMPLER = {
    "mean pressure of each face by itself": (1, False),
    "mean pressure": (1, True),
    "pressure and its tilt": (3, True),
    "all, each face by itself": (PATTERNS, False),
}


class Rung(NamedTuple):
    """A surrogate to judge: its name in result files, what the report calls it, its constants, the
    rail compliance of each condition, and how many modes of each rail vibrate."""

    name: str
    title: str
    calibration: Calibration | None = None
    compliance: Mapping[str, RailCompliance | None] = MappingProxyType({})
    modes: int = 0

    def ask(
        self, study: Study, condition: str, overrides: dict | None = None, tag: str = "", **numerics
    ) -> Run:
        """The run of a condition."""
        vibrating = {"modes": self.modes} if self.modes else {}
        return study.lowfi(
            condition,
            self.calibration,
            overrides,
            tag + "-modal" * bool(self.modes),
            self.compliance.get(condition),
            **vibrating,
            **numerics,
        )


def rungs(study: Study, conditions: Iterable[str] | None = None) -> list[Rung]:
    """The surrogates of a scene for ``conditions``, else for all, from the plainest up: springs
    with the scene's own constants, with calibrated ones, compliant contact, and the same with the
    lowest modes of the rails."""
    static, modes = (
        compliant(study, study.conditions if conditions is None else conditions),
        study.settings.rail_modes,
    )
    return [
        Rung("uncalibrated", f"{SPRINGS}, uncalibrated"),
        Rung("calibrated", f"{SPRINGS}, calibrated", calibrate.load(study)),
        static,
        static._replace(name="modal", title=f"{COMPLIANT}, {modes} modes", modes=modes),
    ]


def compliant(study: Study, conditions: Iterable[str]) -> Rung:
    """The surrogate on compliant contact, for ``conditions``."""
    return Rung("compliant", COMPLIANT, compliance=study.rail_compliances(conditions))


def run(study: Study) -> dict:
    """``uncalibrated``, ``fitted``, ``held_out``, ``compliant`` and ``modal`` rows, ``floor`` and
    ``refinement`` as measured, ``growth`` of 1 um, ``speedup`` of the calibrated and of the
    compliant surrogate, ``simpler`` walls, ``stiffer`` penalty."""
    study.fitted()
    _, calibrated, on_walls, modal = ladder = rungs(study)
    gates = verdicts.gates(study.scene)

    def make() -> tuple[dict, list[Path]]:
        asked = {name: study.highfi(name) for name in study.conditions}
        highfi = dict(zip(asked, study.store.fill("highfi", list(asked.values()))))
        require_success(highfi, "compare")
        changes, floor = refinements(study), floors(study, "reference", study.coarse)
        own = {rung.name: floors(study, rung.title, partial(rung.ask, study)) for rung in ladder}
        table = {
            rung.name: rows(study, rung, highfi, Context([*floor, *own[rung.name]], changes, gates))
            for rung in ladder
        }
        groups = {
            role: [row for row in table["calibrated"] if row["role"] == role]
            for role in ("fitted", "held_out")
        }
        return {
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
            "growth": [asdict(item) for item in _growths(study, on_walls, table["compliant"])],
            "simpler": _simpler(study, on_walls, highfi),
            "stiffer": _stiffer(study, on_walls),
            **dict(zip(("speedup", "speedup_compliant"), _speedups(study, [calibrated, on_walls]))),
        }, []

    return STAGE.run(study, None, make)


def _inputs(study: Study, _: None) -> list:
    return [calibrate.constants(study), verdicts.gates(study.scene)]


STAGE = Stage("agreement", __name__, inputs=_inputs)
stored = STAGE.stored


def rows(study: Study, rung: Rung, highfi: dict[str, Trajectory], context: Context) -> list[dict]:
    """Agreement of one surrogate on every condition."""
    wanted = {name: rung.ask(study, name) for name in study.conditions}
    found = dict(zip(wanted, study.store.fill(rung.title, list(wanted.values()))))
    return [
        verdicts.row(name, role, highfi[name], found[name], context)
        for role in ("fitted", "held_out")
        for name in getattr(study.scene.agreement, role)
    ]


def _simpler(study: Study, compliant: Rung, highfi: dict[str, Trajectory]) -> list[dict]:
    """What each part of the walls' flexibility is worth: the errors of surrogates that know less of
    it."""
    found = []
    for words, (patterns, coupled) in _SIMPLER.items():
        rung = compliant._replace(
            compliance={
                name: known and known.restricted(patterns, coupled)
                for name, known in compliant.compliance.items()
            }
        )
        wanted = [
            rung.ask(study, name, tag=f"-{patterns}{'' if coupled else '-apart'}")
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


def _stiffer(study: Study, compliant: Rung) -> list[dict]:
    """What four times the penalty moves in either model, and how far apart they are with it, the
    reference on the coarse mesh: a stiffness that both share makes the reference uncertain, but is
    no difference between them."""
    names = [
        name
        for name in study.conditions
        if name in study.scene.agreement.refined and study.scene.contact is not None
    ]
    groups = {
        name: (
            study.coarse(name),
            refined(study, name)["penalty"],
            compliant.ask(study, name),
            compliant.ask(study, name, _more_penalty(study), "-penalty"),
        )
        for name in names
    }
    runs = iter(study.store.fill("penalty", [run for group in groups.values() for run in group]))
    found = []
    for name, group in groups.items():
        reference, stiff_reference, surrogate, stiff_surrogate = (next(runs) for _ in group)
        found.append(
            {
                "condition": name,
                "reference_change_deg_s": verdicts.settled_change(reference, stiff_reference),
                "surrogate_change_deg_s": verdicts.settled_change(surrogate, stiff_surrogate),
                "apart_deg_s": verdicts.settled_change(reference, surrogate),
                "apart_with_more_deg_s": verdicts.settled_change(stiff_reference, stiff_surrogate),
            }
        )
    return found


def floors(study: Study, model: str, ask: Callable[..., Run]) -> list[Spread]:
    """Spread of one model under +-1 um of clearance, on the conditions the scene names for it."""
    if study.scene.contact is None:
        return []
    return [
        spread(name, model, "clearance", nominal, changed)
        for name, (nominal, *changed) in _twins(
            study, f"floor, {model}", ask, study.scene.agreement.floor
        ).items()
    ]


def _growths(study: Study, compliant: Rung, rows: list[dict]) -> list[growth.Growth]:
    """How 1 um of clearance grows in both models, on the conditions of the floor and on those whose
    reference is not converged: that they are chaotic may be why."""
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
        for model, ask in (
            (FINITE_ELEMENTS, study.coarse),
            (compliant.title, partial(compliant.ask, study)),
        )
        for name, (nominal, *changed) in _twins(study, f"growth, {model}", ask, names).items()
    ]


def _twins(
    study: Study, title: str, ask: Callable[..., Run], names: Iterable[str]
) -> dict[str, list[Trajectory]]:
    """The run of each condition, and those that differ from it by 1 um of clearance."""
    groups = {
        name: [ask(name)]
        + [
            ask(name, overrides={"contact.clearance": clearance}, tag=f"-clearance-{sign}")
            for sign, clearance in clearances(study)
        ]
        for name in names
    }
    runs = iter(study.store.fill(title, [run for group in groups.values() for run in group]))
    return {name: [next(runs) for _ in group] for name, group in groups.items()}


def clearances(study: Study) -> list[tuple[str, float]]:
    """The perturbed clearances (m) that are physical, of a scene with contact: a closed gap is only
    opened."""
    assert study.scene.contact is not None
    nominal, change = study.scene.contact.clearance, study.settings.clearance_change
    return [
        (sign, value)
        for sign, value in (("plus", nominal + change), ("minus", nominal - change))
        if value >= 0.0
    ]


def refinements(study: Study) -> list[Spread]:
    """Spread of the reference under each refinement alone: the mesh from the coarse one to its own,
    on every condition, for one that is chaotic shows itself there; the others on the coarse one,
    where the scene asks for it."""
    found, groups = [], _refinement_runs(study)
    runs = study.store.fill(
        "refinement", [run for group in groups.values() for run in group.values()]
    )
    for name, group in groups.items():
        _, *causes = group
        coarse, *changed = [runs.pop(0) for _ in group]
        found += [
            spread(name, "reference", cause, coarse, [one]) for cause, one in zip(causes, changed)
        ]
    return found


def asked_of_the_reference(study: Study) -> list[Run]:
    """Every run from which ``refinements`` knows how sure the reference is, its own on every
    condition among them."""
    return [run for group in _refinement_runs(study).values() for run in group.values()]


def _refinement_runs(study: Study) -> dict[str, dict[str, Run]]:
    return {
        name: {"coarse": study.coarse(name), "mesh": study.highfi(name)}
        | (refined(study, name) if name in study.scene.agreement.refined else {})
        for name in study.conditions
    }


def refined(study: Study, name: str) -> dict[str, Run]:
    """Runs on the coarse mesh with half the step and with four times the penalty."""
    runs = {"step": study.coarse(name, tag="-step", safety=0.45)}
    if study.scene.contact is not None:
        runs["penalty"] = study.coarse(name, _more_penalty(study), "-penalty")
    return runs


def _more_penalty(study: Study) -> dict[str, float]:
    assert study.scene.contact is not None  # or nobody asks for more
    return {"contact.penalty": 4.0 * study.scene.contact.penalty}


def _speedups(study: Study, ladder: list[Rung]) -> list[dict]:
    name, settings = study.fitted()[0], study.settings
    with Board("speed-up", 1) as board:
        found = speedups(
            study.highfi(name),
            {rung.name: rung.ask(study, name) for rung in ladder},
            settings.highfi_repeats,
            settings.lowfi_repeats,
            board.callback("speed-up"),
        )
        board.finished(
            "speed-up", " and ".join(f"{item['ratio']:,.0f} times" for item in found.values())
        )
    return [item | {"condition": name} for item in found.values()]
