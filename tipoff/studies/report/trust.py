"""How far the answer can be trusted: what is known of the errors of numerics, model and inputs."""

from tipoff.scenes import provenance
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.report import inputs
from tipoff.uncertain import LEAST, number


def lines(
    scene: Scene, compared: dict[str, verdicts.JudgedCondition], agreement: Agreement | None
) -> list[str]:
    """One sentence each on numerics, model and inputs."""
    return [*_numerics(compared), *_model(compared), *_inputs(scene, agreement)]


def uncertainty(row: verdicts.JudgedCondition | None) -> float | None:
    """Of the reference on a condition (deg/s); None if it is not known."""
    return None if row is None else row.reference_uncertainty_deg_s


def _numerics(compared: dict[str, verdicts.JudgedCondition]) -> list[str]:
    known = {
        name: value for name, row in compared.items() if (value := uncertainty(row)) is not None
    }
    if not known:
        return ["numerics: the uncertainty of the reference is not measured"]
    name = max(known, key=lambda name: known[name])
    open_ = [name for name, row in compared.items() if not row.reference_converged]
    return [
        "numerics: the uncertainty of the reference by mesh, step and contact cells is at most "
        f"{number(known[name], '.2g', LEAST)} deg/s ({name})"
        + (f"; it is not converged on {', '.join(open_)}" if open_ else "")
    ]


def _model(compared: dict[str, verdicts.JudgedCondition]) -> list[str]:
    errors = [
        row.settled_rate_error_deg_s
        for row in compared.values()
        if row.is_judged_as_curve and row.settled_rate_error_deg_s is not None
    ]
    chaotic = [row for row in compared.values() if row.judged_as == verdicts.DISTRIBUTION]
    alike = sum(row.judgement == verdicts.AS_DISTRIBUTION for row in chaotic)
    found = (
        "model: on conditions judged as curves, the surrogate is within "
        f"{number(max(errors), '.2g', LEAST)} deg/s of the finite elements; "
        if errors
        else "model: no condition can be judged as a curve; "
        if compared
        else "model: surrogate and finite elements were not compared (tipoff compare); "
    )
    if chaotic:
        found += f"as distributions {alike} of {len(chaotic)} conditions agree; "
    return [f"{found}neither model was validated on a measured ejection"]


def _inputs(scene: Scene, agreement: Agreement | None) -> list[str]:
    assumed, every = 0, 0
    for key, _, _, was_stated in inputs.values(scene):
        every += 1
        text = provenance.nearest(scene.provenance, key) or ""
        assumed += text.startswith("assumed") or (was_stated and not text)
    moved = ""
    if agreement is not None:
        floor = verdicts.largest(row.floor_deg_s for row in agreement.compliant)
        change = verdicts.largest(row.reference_change_deg_s for row in agreement.interface)
        if floor is not None:
            moved += (
                f"; 1 µm of clearance changes a rate by up to {number(floor, '.2g', LEAST)} deg/s"
            )
        if change is not None:
            moved += (
                f"; a quarter or four times the interface stiffness by up to "
                f"{number(change, '.2g', LEAST)} deg/s"
            )
    return [f"inputs: {assumed} of {every} values are assumed or have no stated source{moved}"]
