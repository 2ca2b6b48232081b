"""Stage ``compare``: agreement of the surrogate with the reference, uncalibrated and calibrated, on conditions it was fitted to
and on conditions it never saw, beside the floor and the uncertainty of the reference; and the speed-up."""

from dataclasses import asdict
from pathlib import Path

from scenes.calibration import Calibration
from studies import agreement
from studies.agreement import Context, Spread, spread
from studies.progress import Board
from studies.stages import calibrate
from studies.store import SOURCES, Run
from studies.study import Study, require_success
from studies.timing import speedup

SOURCES_USED = (*SOURCES["highfi"], *SOURCES["lowfi"], "calibrate")


def run(study: Study) -> dict:
    """``uncalibrated``, ``fitted``, ``held_out`` rows, ``floor`` and ``refinement`` as measured, ``speedup``."""
    study.fitted()
    calibration = calibrate.load(study)

    def make() -> tuple[dict, list[Path]]:
        highfi, plain, fitted = _runs(study, calibration)
        context = {kind: Context(_floors(study, cause), _refinements(study)) for kind, cause in
                   (("uncalibrated", None), ("calibrated", calibration))}
        roles = {"fitted": study.scene.agreement.fitted, "held_out": study.scene.agreement.held_out}
        rows = {role: [agreement.row(name, role, highfi[name], fitted[name], context["calibrated"])
                       | {"outside_calibration": calibration.outside(study.condition(name))} for name in names]
                for role, names in roles.items()}
        before = [agreement.row(name, role, highfi[name], plain[name], context["uncalibrated"])
                  for role, names in roles.items() for name in names]
        floors = _unique([*context["uncalibrated"].floors, *context["calibrated"].floors])
        return {"uncalibrated": before, **rows, "gates": agreement.GATES, "converged_deg_s": agreement.CONVERGED_DEG_S,
                "clearance_change_m": study.settings.clearance_change, "floor": [asdict(item) for item in floors],
                "refinement": [asdict(item) for item in context["calibrated"].refinements],
                "speedup": _speedup(study, calibration)}, []

    return study.stage("agreement", study.key(SOURCES_USED, calibration.constants, agreement.GATES), make)


def calibrated_runs(study: Study, calibration: Calibration | None) -> dict[str, Run]:
    """The surrogate's run of every condition."""
    return {name: study.lowfi(name, calibration) for name in study.conditions}


def _runs(study: Study, calibration: Calibration):
    asked = {name: study.highfi(name) for name in study.conditions}
    highfi = dict(zip(asked, study.store.fill("highfi", list(asked.values()))))
    require_success(highfi, "compare")
    surrogate = []
    for title, constants in (("lowfi", None), ("lowfi, calibrated", calibration)):
        wanted = calibrated_runs(study, constants)
        surrogate.append(dict(zip(wanted, study.store.fill(title, list(wanted.values())))))
    return highfi, *surrogate


def _floors(study: Study, calibration: Calibration | None) -> list[Spread]:
    """Spread of both models under +-1 um of clearance, on the conditions the scene names for it."""
    if study.scene.contact is None:
        return []
    model = "calibrated surrogate" if calibration else "uncalibrated surrogate"
    found = []
    for label, ask in (("reference", study.coarse), (model, _surrogate(study, calibration))):
        groups = {name: [ask(name)] + [ask(name, overrides={"contact.clearance": clearance}, tag=f"-clearance-{sign}")
                                       for sign, clearance in clearances(study)] for name in study.scene.agreement.floor}
        runs = study.store.fill(f"floor, {label}", [run for group in groups.values() for run in group])
        for name, group in groups.items():
            nominal, *changed = [runs.pop(0) for _ in group]
            found.append(spread(name, label, "clearance", nominal, changed))
    return found


def clearances(study: Study) -> list[tuple[str, float]]:
    """The perturbed clearances (m) that are physical: a closed gap is only opened."""
    nominal, change = study.scene.contact.clearance, study.settings.clearance_change
    return [(sign, value) for sign, value in (("plus", nominal + change), ("minus", nominal - change)) if value >= 0.0]


def _surrogate(study: Study, calibration: Calibration | None):
    def ask(name: str, overrides: dict | None = None, tag: str = "") -> Run:
        return study.lowfi(name, calibration, overrides, tag)

    return ask


def _refinements(study: Study) -> list[Spread]:
    """Spread of the reference under each refinement alone: the mesh from the coarse one to its own, on every condition, for one that
    is chaotic shows itself there; the others on the coarse one, where the scene asks for it."""
    found = []
    groups = {name: {"coarse": study.coarse(name), "mesh": study.highfi(name)}
              | (refined(study, name) if name in study.scene.agreement.refined else {}) for name in study.conditions}
    runs = study.store.fill("refinement", [run for group in groups.values() for run in group.values()])
    for name, group in groups.items():
        _, *causes = group
        coarse, *changed = [runs.pop(0) for _ in group]
        found += [spread(name, "reference", cause, coarse, [one]) for cause, one in zip(causes, changed)]
    return found


def refined(study: Study, name: str) -> dict[str, Run]:
    """Runs on the coarse mesh with half the step and with four times the penalty."""
    runs = {"step": study.coarse(name, tag="-step", safety=0.45)}
    if study.scene.contact is not None:
        runs["penalty"] = study.coarse(name, {"contact.penalty": 4.0 * study.scene.contact.penalty}, "-penalty")
    return runs


def _speedup(study: Study, calibration: Calibration) -> dict:
    name = study.fitted()[0]
    settings = study.settings
    with Board("speed-up", 1) as board:
        found = speedup(study.highfi(name), study.lowfi(name, calibration), settings.highfi_repeats, settings.lowfi_repeats,
                        board.callback("speed-up"))
        board.finished("speed-up", f"{found['ratio']:,.0f} times")
    return found | {"condition": name}


def _unique(spreads: list[Spread]) -> list[Spread]:
    return list(dict.fromkeys(spreads))
