"""Stage ``convergence``: the error of the finite-element reference, on one condition.

Meshes and steps are refined separately, and the uncertainty of every quantity is estimated from its
observed order (``comparison.extrapolation``). Deflection and natural frequencies of the rail
(``studies.convergence.statics``) are refined too. Runs with other interface stiffness and contact cells
are compared. A finer mesh has a smaller step, and contact cells of at most half a
facet. A wall has at least one element through its thickness, so coarse meshes differ in length and width
only; ``meshes`` has the numbers of elements. Finally both fidelities are timed at equal accuracy
(``studies.agreement.equal_accuracy``)."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from tipoff.comparison.extrapolation import Estimate, estimate
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import equal_accuracy, interface, refinement, verdicts
from tipoff.studies.agreement.candidates import compliant
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.convergence import contact_loads, statics, stresses
from tipoff.studies.convergence.options import ConvergenceOptions
from tipoff.studies.convergence.quantities import RATE, quantities, settled_rate
from tipoff.studies.render.column import Column
from tipoff.workspace.progress import Board
from tipoff.workspace.run import Run
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, require_success
from tipoff.workspace.timing import speedups

NAME = "convergence"
_LEAST = 3  # meshes, the fewest for an observed order
_LONG = 60.0  # s; a longer run of the reference is timed only once


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Elements, step and wall time of the reference on one mesh."""

    element_size_m: float
    elements: int
    dt_s: float
    wall_s: float


@dataclass(frozen=True, kw_only=True)
class Refined(Estimate):
    """A quantity over the ``sizes`` of a refined ``parameter``, coarsest first; a value is None if
    a run did not settle. ``nominal_uncertainty``: at the size that other stages use."""

    quantity: str
    unit: str
    parameter: str
    sizes: list[float]
    size_unit: str
    values: list[float | None]  # in the unit of the quantity
    nominal_size: float
    nominal_uncertainty: float | None


@dataclass(frozen=True, kw_only=True)
class Change:
    """Settled rates (deg/s) about x, y, z of a changed run, and the largest change against the
    nominal run of the coarse mesh; None if it did not settle."""

    status: Annotated[str, Column("status")]
    settled_rate_deg_s: Annotated[list[float | None], Column("settled x, y, z", "deg/s", ".3f")]
    settled_rate_change_deg_s: Annotated[float | None, Column("largest change", "deg/s", ".2g")]


@dataclass(frozen=True, kw_only=True)
class OtherStiffness(Change):
    """A run with ``factor`` times the interface stiffness."""

    factor: Annotated[float, Column("factor", form="g")]
    interface_stiffness_n_m3: Annotated[float, Column("interface stiffness", "N/m³")]


@dataclass(frozen=True, kw_only=True)
class OtherCells(Change):
    """A run with another number of contact cells."""

    cells_per_edge: Annotated[int, Column("contact cells along each edge of a pad")]


@dataclass(frozen=True, kw_only=True)
class Convergence:
    """``quantities`` over element size and time step with order and uncertainty; runs with other
    ``interface_stiffness`` and ``contact_cells``, empty without contact. ``equal_accuracy`` is None if no pad
    touches, or if compliant contact or a mesh did not settle."""

    condition: str
    element_size_m: float
    coarse_size_m: float
    force_cutoff_hz: float
    meshes: tuple[Mesh, ...]
    quantities: tuple[Refined, ...]
    interface_stiffness: tuple[OtherStiffness, ...]
    contact_cells: tuple[OtherCells, ...]
    equal_accuracy: EqualAccuracy | None

    def refined(self, parameter: str, quantity: str = "") -> list[Refined]:
        """The rows of a refined parameter whose quantity begins with these words."""
        return [
            row
            for row in self.quantities
            if row.parameter == parameter and row.quantity.startswith(quantity)
        ]


def run(study: Study, options: ConvergenceOptions | None = None) -> Made[Convergence]:
    """The error of the reference. Raises SceneError for an unknown condition, StudyError if a
    mesh or a step fails."""
    given = options and options.condition
    name = given or (study.scene.agreement.refined or tuple(study.conditions))[0]
    scene = study.condition(name)

    def make() -> tuple[Convergence, list[Path]]:
        asked, sizes = refinement.mesh_sizes(study, scene, study.settings.mesh_sizes, _LEAST)
        nominal = sizes[asked.index(study.settings.element_size)]
        meshes = _finished(study, "convergence, meshes", refinement.meshes(study, name, asked))
        steps = _finished(
            study, "convergence, steps", refinement.steps(study, name, study.settings.safeties)
        )
        by_mesh = [*quantities(scene, meshes), *statics.quantities(scene, asked)]
        in_space = _judged("element size", "m", sizes, nominal, by_mesh)
        if not stresses.has_limit(scene):
            in_space = [_without_limit(row) for row in in_space]
        dt = [found.cost["dt_s"] for found in steps]
        in_time = _judged("time step", "s", dt, dt[0], quantities(scene, steps))
        touching = scene.contact is not None
        return Convergence(
            condition=name,
            element_size_m=study.settings.element_size,
            coarse_size_m=study.settings.coarse_size,
            force_cutoff_hz=contact_loads.cutoff(scene),
            meshes=tuple(
                Mesh(
                    element_size_m=size,
                    elements=int(found.cost["elements"]),
                    dt_s=found.cost["dt_s"],
                    wall_s=found.cost["wall_s"],
                )
                for size, found in zip(sizes, meshes)
            ),
            quantities=(*in_space, *in_time),
            interface_stiffness=_interfaces(study, name) if touching else (),
            contact_cells=_cells(study, name) if touching else (),
            equal_accuracy=_at_equal_accuracy(study, name, in_space, dict(zip(sizes, meshes))),
        ), []

    return STAGE.run(study, name, make)


STAGE = Stage(NAME, __name__, options=str, field="condition", result=Convergence)


def _finished(study: Study, title: str, wanted: list[Run]) -> list[Trajectory]:
    runs = study.store.fill(title, wanted)
    require_success(
        {item.label: found for item, found in zip(wanted, runs)}, "judge the convergence"
    )
    return runs


def _judged(
    parameter: str,
    unit: str,
    sizes: list[float],
    nominal: float,
    values_of: Iterable[tuple[str, str, Sequence[float | None]]],
) -> list[Refined]:
    """A row for each quantity over ``sizes``, coarsest first; other stages use the ``nominal``
    size."""
    rows = []
    for quantity, its_unit, values in values_of:
        found = estimate(sizes, values)
        at_nominal, finest = values[sizes.index(nominal)], values[-1]
        rows.append(
            Refined(
                **vars(found),
                quantity=quantity,
                unit=its_unit,
                parameter=parameter,
                sizes=sizes,
                size_unit=unit,
                values=list(values),
                nominal_size=nominal,
                nominal_uncertainty=None
                if found.uncertainty is None or at_nominal is None or finest is None
                else found.uncertainty + abs(at_nominal - finest),
            )
        )
    return rows


def _without_limit(row: Refined) -> Refined:
    """``row``; that of the peak stress without an uncertainty."""
    if row.quantity != stresses.PEAK:
        return row
    unknown = Estimate(row.order, None, None, stresses.SINGULAR)
    return replace(row, **vars(unknown), nominal_uncertainty=None)


def _interfaces(study: Study, name: str) -> tuple[OtherStiffness, ...]:
    contact = study.condition(name).contact
    assert contact is not None
    factors = study.settings.interface_stiffness_factors
    wanted = [interface.reference(study, name, factor) for factor in factors]
    found = _changes(study, "convergence, interface stiffness", name, wanted)
    return tuple(
        OtherStiffness(
            factor=factor, interface_stiffness_n_m3=factor * contact.series_stiffness(), **change
        )
        for factor, change in zip(factors, found)
    )


def _cells(study: Study, name: str) -> tuple[OtherCells, ...]:
    counts = study.settings.contact_cells
    wanted = refinement.contact_cells(study, name, counts)
    found = _changes(study, "convergence, contact cells", name, wanted)
    return tuple(OtherCells(cells_per_edge=count, **own) for count, own in zip(counts, found))


def _changes(study: Study, title: str, name: str, wanted: list[Run]) -> list[dict[str, Any]]:
    """The fields of a ``Change`` of each run."""
    nominal, *runs = study.store.fill(title, [study.coarse(name), *wanted])
    return [
        {
            "status": found.status,
            "settled_rate_deg_s": settled_rate(found),
            "settled_rate_change_deg_s": verdicts.settled_change(nominal, found),
        }
        for found in runs
    ]


def _at_equal_accuracy(
    study: Study, name: str, judged: list[Refined], meshes: dict[float, Trajectory]
) -> EqualAccuracy | None:
    """The speed-up of compliant contact over the coarsest mesh whose uncertainty is below its error."""
    rates = [row for row in judged if row.quantity.startswith(RATE)]
    uncertainties = equal_accuracy.uncertainties([(row.values, row.uncertainty) for row in rates])
    if study.scene.contact is None or uncertainties is None:
        return None
    surrogate = compliant(study, [name]).request(study, name)
    error = verdicts.settled_change(
        list(meshes.values())[-1], *study.store.fill("convergence, surrogate", [surrogate])
    )
    if error is None:
        return None
    size, uncertainty = equal_accuracy.coarsest(list(meshes), uncertainties, error)
    wall, words = meshes[size].cost["wall_s"], f"{1e3 * size:g} mm"
    with Board("speed at equal accuracy", 1) as board:
        (found,) = speedups(
            study.highfi(name, element_size=size),
            {"compliant": surrogate},
            1 if wall > _LONG else study.settings.highfi_repeats,
            study.settings.lowfi_repeats,
            board.callback(words),
        ).values()
        board.finished(words, f"{found.ratio:,.0f} times")
    return EqualAccuracy(
        **vars(found) | {"condition": name},
        error_deg_s=error,
        element_size_m=size,
        mesh_uncertainty_deg_s=uncertainty,
        surer=uncertainty < error,
    )
