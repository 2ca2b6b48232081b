"""Stage ``convergence``: the error of the finite-element reference, on one condition.

Meshes and steps are refined separately, and the uncertainty of every quantity is estimated from its
observed order (``comparison.extrapolation``). Deflection and natural frequencies of the rail
(``studies.convergence.statics``) stand beside the settled rates. Interface stiffness and contact cells
are changed and compared. A straight slide shows the ripple of a constant force by the facets
(``studies.convergence.ripple``). A finer mesh has a smaller step, and contact cells no longer than
half a facet. A wall has at least one element through its thickness, so coarse meshes differ in length and width only;
``meshes`` holds the numbers of elements. Finally both fidelities are timed at equal accuracy
(``studies.agreement.equal_accuracy``)."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

from tipoff.comparison.extrapolation import Estimate, estimate
from tipoff.highfi.numerics import Numerics
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import equal_accuracy, interface, refinement, verdicts
from tipoff.studies.agreement.candidates import compliant
from tipoff.studies.convergence import contact_loads, ripple, statics, stresses
from tipoff.studies.convergence.quantities import RATE, quantities, settled_rate
from tipoff.workspace.progress import Board
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, require_success
from tipoff.workspace.timing import speedups

NAME = "convergence"
_LEAST = 3  # meshes, of which an order can be observed
_FEW_CELLS = 3  # along each edge of a pad: longer than the facets it slides over
_LONG = 60.0  # s, a run of the reference that is timed once only


def run(study: Study, condition: str | None = None) -> dict:
    """``quantities`` over element size and time step with order and uncertainty,
    ``interface_stiffness``, ``contact_cells``, ``ripple`` and ``equal_accuracy``. Raises SceneError
    for an unknown condition, StudyError where a mesh or a step fails."""
    name = condition or (study.scene.agreement.refined or tuple(study.conditions))[0]
    scene = study.condition(name)

    def make() -> tuple[dict, list[Path]]:
        asked, sizes = refinement.mesh_sizes(study, scene, study.settings.mesh_sizes, _LEAST)
        nominal = sizes[asked.index(study.settings.element_size)]
        meshes = _finished(study, "convergence, meshes", refinement.meshes(study, name, asked))
        steps = _finished(
            study, "convergence, steps", refinement.steps(study, name, study.settings.safeties)
        )
        by_mesh = [*quantities(scene, meshes), *statics.quantities(scene, asked)]
        judged = [
            *_judged(_Parameter("element size", "m", sizes, nominal), by_mesh),
            *_judged(_time_step(steps), quantities(scene, steps)),
        ]
        interface_stiffness, contact_cells, ripples = (
            _interfaces(study, name),
            _cells(study, name),
            _ripples(study, scene),
        )
        equal = _at_equal_accuracy(study, name, judged, dict(zip(sizes, meshes)))
        return {
            "condition": name,
            "element_size_m": study.settings.element_size,
            "coarse_size_m": study.settings.coarse_size,
            "force_cutoff_hz": contact_loads.cutoff(scene),
            "meshes": [
                {
                    "element_size_m": size,
                    "elements": found.cost["elements"],
                    "dt_s": found.cost["dt_s"],
                    "wall_s": found.cost["wall_s"],
                }
                for size, found in zip(sizes, meshes)
            ],
            "quantities": judged,
            "interface_stiffness": interface_stiffness,
            "contact_cells": contact_cells,
            "ripple": ripples,
            "equal_accuracy": equal,
        }, []

    return STAGE.run(study, name, make)


STAGE = Stage(NAME, __name__, str, field="condition")
stored = STAGE.stored


def _finished(study: Study, title: str, wanted: list[Run]) -> list[Trajectory]:
    runs = study.store.fill(title, wanted)
    require_success(
        {item.label: found for item, found in zip(wanted, runs)}, "judge the convergence"
    )
    return runs


class _Parameter(NamedTuple):
    """What is refined: its name, unit, ``sizes``, coarsest first, and the ``nominal`` one, which all
    other stages use."""

    name: str
    unit: str
    sizes: list[float]
    nominal: float


def _time_step(steps: list[Trajectory]) -> _Parameter:
    sizes = [found.cost["dt_s"] for found in steps]
    return _Parameter("time step", "s", sizes, sizes[0])


def _judged(
    parameter: _Parameter, values_of: Iterable[tuple[str, str, Sequence[float | None]]]
) -> list[dict]:
    """One row a quantity. ``nominal_uncertainty`` is that at the nominal size."""
    rows = []
    for quantity, its_unit, values in values_of:
        found = estimate(parameter.sizes, values)
        at_nominal, finest = values[parameter.sizes.index(parameter.nominal)], values[-1]
        if quantity == stresses.PEAK and parameter.unit == "m":
            found = Estimate(found.order, None, None, stresses.SINGULAR)
        rows.append(
            {
                "quantity": quantity,
                "unit": its_unit,
                "parameter": parameter.name,
                "sizes": parameter.sizes,
                "size_unit": parameter.unit,
                "values": list(values),
                **asdict(found),
                "nominal_size": parameter.nominal,
                "nominal_uncertainty": None
                if found.uncertainty is None or at_nominal is None or finest is None
                else found.uncertainty + abs(at_nominal - finest),
            }
        )
    return rows


def _interfaces(study: Study, name: str) -> list[dict]:
    """Rows by interface stiffness; none without contact."""
    contact = study.condition(name).contact
    if contact is None:
        return []
    factors = study.settings.interface_stiffness_factors
    heads = [
        {"factor": factor, "interface_stiffness_n_m3": factor * contact.series_stiffness()}
        for factor in factors
    ]
    wanted = [interface.reference(study, name, factor) for factor in factors]
    return _compared(study, "convergence, interface stiffness", name, heads, wanted)


def _cells(study: Study, name: str) -> list[dict]:
    """Rows by contact cells along each edge of a pad; none without contact."""
    if study.condition(name).contact is None:
        return []
    wanted = refinement.contact_cells(study, name, study.settings.contact_cells)
    heads = [{"cells_per_edge": count} for count in study.settings.contact_cells]
    return _compared(study, "convergence, contact cells", name, heads, wanted)


def _ripples(study: Study, scene: Scene) -> list[dict]:
    """Rows by element size, the first with few contact cells for comparison; none where
    ``ripple.measure`` gives None."""
    rows = []
    for size, cells in (
        (study.settings.coarse_size, _FEW_CELLS),
        (study.settings.coarse_size, None),
        (study.settings.element_size, None),
    ):
        numerics = Numerics(element_size=size, cells=cells)
        if found := ripple.measure(scene, numerics):
            rows.append(
                {
                    "element_size_m": size,
                    **found._asdict(),
                }
            )
    return rows


def _at_equal_accuracy(
    study: Study, name: str, judged: list[dict], meshes: dict[float, Trajectory]
) -> dict | None:
    """The speed-up of compliant contact over the coarsest mesh whose uncertainty is below its
    error; None where nothing touches, or where it or a mesh did not settle."""
    rates = [
        row
        for row in judged
        if row["parameter"] == "element size" and row["quantity"].startswith(RATE)
    ]
    uncertainties = equal_accuracy.uncertainties(rates)
    if study.scene.contact is None or uncertainties is None:
        return None
    surrogate = compliant(study, [name]).request(study, name)
    error = verdicts.settled_change(
        list(meshes.values())[-1], *study.store.fill("convergence, surrogate", [surrogate])
    )
    if error is None:
        return None
    mesh = equal_accuracy.coarsest(list(meshes), uncertainties, error)
    wall = meshes[mesh.element_size].cost["wall_s"]
    with Board("speed at equal accuracy", 1) as board:
        (found,) = speedups(
            study.highfi(name, element_size=mesh.element_size),
            {"compliant": surrogate},
            1 if wall > _LONG else study.settings.highfi_repeats,
            study.settings.lowfi_repeats,
            board.callback(f"{1e3 * mesh.element_size:g} mm"),
        ).values()
        board.finished(f"{1e3 * mesh.element_size:g} mm", f"{found.ratio:,.0f} times")
    return asdict(found) | {
        "condition": name,
        "error_deg_s": error,
        "element_size_m": mesh.element_size,
        "mesh_uncertainty_deg_s": mesh.uncertainty,
        "surer": mesh.sufficient,
    }


def _compared(
    study: Study, title: str, name: str, heads: list[dict], wanted: list[Run]
) -> list[dict]:
    """The rows with the settled rates of their runs and the largest change of one (deg/s) against
    the nominal run of the coarse mesh."""
    nominal, *runs = study.store.fill(title, [study.coarse(name), *wanted])
    return [
        head
        | {
            "status": found.status,
            "settled_rate_deg_s": settled_rate(found),
            "settled_rate_change_deg_s": verdicts.settled_change(nominal, found),
        }
        for head, found in zip(heads, runs)
    ]
