"""Stage ``convergence``: the error of the finite-element reference, on one condition.

Meshes and steps are refined separately, and the uncertainty of every quantity is estimated from its
observed order (``studies.convergence.extrapolation``). Interface stiffness and quadrature are
changed and compared. A straight slide shows the ripple of a constant force by the facets
(``studies.convergence.ripple``). A finer mesh has a smaller step and fewer Gauss points per facet,
which stay about 1 mm apart, so that their error appears in the quadrature alone. A wall has at
least one element through its thickness, so coarse meshes differ in length and width only;
``meshes`` holds the numbers of elements. Finally both fidelities are timed at equal accuracy
(``studies.convergence.equal_accuracy``)."""

from dataclasses import asdict
from pathlib import Path

from tipoff.highfi.numerics import Numerics
from tipoff.highfi.rail import refinement
from tipoff.mechanics.trajectory import Trajectory
from tipoff.scenes.scene import Scene
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.stage import compliant, refined
from tipoff.studies.convergence import contact_loads, equal_accuracy, ripple, stresses
from tipoff.studies.convergence.extrapolation import Estimate, estimate
from tipoff.studies.convergence.quantities import RATE, quantities, settled_rate
from tipoff.studies.core.progress import Board, say
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.store import Run
from tipoff.studies.core.study import Study, require_success
from tipoff.studies.cost.timing import speedups

NAME = "convergence"
_LEAST = 3  # meshes, of which an order can be observed
_LONG = 60.0  # s, a run of the reference that is timed once only


def run(study: Study, condition: str | None = None) -> dict:
    """``quantities`` over element size and time step with order and uncertainty,
    ``interface_stiffness``, ``quadrature``, ``ripple`` and ``equal_accuracy``. Raises SceneError
    for an unknown condition, StudyError where a mesh or a step fails."""
    name = condition or (study.scene.agreement.refined or tuple(study.conditions))[0]
    scene = study.condition(name)

    def make() -> tuple[dict, list[Path]]:
        asked, sizes = mesh_sizes(study, scene)
        nominal = sizes[asked.index(study.settings.element_size)]
        meshes = _finished(study, "convergence, meshes", _meshes(study, name, asked))
        steps = _finished(study, "convergence, steps", _steps(study, name))
        judged = [
            *_judged(
                scene,
                "element size",
                "m",
                sizes,
                meshes,
                nominal,
            ),
            *_judged(
                scene,
                "time step",
                "s",
                [found.cost["dt_s"] for found in steps],
                steps,
                steps[0].cost["dt_s"],
            ),
        ]
        interface_stiffness, quadrature, ripples = (
            _interfaces(study, name),
            _quadratures(study, name),
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
            "quadrature": quadrature,
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


def mesh_sizes(study: Study, scene: Scene) -> tuple[list[float], list[float]]:
    """Element sizes (m) to ask for, coarsest first, and those of the meshes that they give. A file
    gives one mesh for several sizes: the size of the other stages, or else the smallest, stands for
    them, and finer ones follow until there are three, where they fit."""
    given = list(study.settings.mesh_sizes)
    own: dict[float, float] = {}
    for asked, size in zip(given, refinement.sizes(scene, given)):
        if own.get(size) != study.settings.element_size:
            own[size] = asked
    while len(own) < _LEAST:
        finer = 0.5 * min(own)
        if reason := refinement.too_fine(scene, finer):
            say(f"  a finer mesh is left out: {reason}")
            break
        own[finer] = finer
    return list(own.values()), list(own)


def _meshes(study: Study, name: str, sizes: list[float]) -> list[Run]:
    """One run a mesh; runs that other stages make too keep their name, so that the store has them
    only once."""
    settings = study.settings
    known = {
        2.0 * settings.coarse_size: "-coarsest",
        settings.coarse_size: "-coarse",
        settings.element_size: "",
    }
    return [
        study.highfi(name, element_size=size, tag=known.get(size, f"-{1e3 * size:g}mm"))
        for size in sizes
    ]


def _steps(study: Study, name: str) -> list[Run]:
    known = {Numerics().safety: study.coarse(name), 0.45: refined(study, name)["step"]}
    return [
        known.get(safety) or study.coarse(name, tag=f"-safety-{safety:g}", safety=safety)
        for safety in study.settings.safeties
    ]


def _judged(
    scene: Scene,
    parameter: str,
    unit: str,
    sizes: list[float],
    runs: list[Trajectory],
    nominal: float,
) -> list[dict]:
    """One row a quantity. ``nominal_uncertainty`` is that at the ``nominal`` size, which all other
    stages use."""
    rows = []
    for quantity, its_unit, values in quantities(scene, runs):
        found = estimate(sizes, values)
        at_nominal, finest = values[sizes.index(nominal)], values[-1]
        if quantity == stresses.PEAK and parameter == "element size":
            found = Estimate(found.order, None, None, stresses.SINGULAR)
        rows.append(
            {
                "quantity": quantity,
                "unit": its_unit,
                "parameter": parameter,
                "sizes": sizes,
                "size_unit": unit,
                "values": values,
                **asdict(found),
                "nominal_size": nominal,
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
    stiffness = contact.interface_stiffness
    heads = [
        {"factor": factor, "interface_stiffness_n_m3": factor * stiffness}
        for factor in study.settings.interface_stiffness_factors
    ]
    known = {1.0: study.coarse(name), 4.0: refined(study, name)["interface_stiffness"]}
    wanted = [
        known.get(factor)
        or study.coarse(
            name, {"contact.interface_stiffness": factor * stiffness}, f"-interface-{factor:g}"
        )
        for factor in study.settings.interface_stiffness_factors
    ]
    return _compared(study, "convergence, interface stiffness", name, heads, wanted)


def _quadratures(study: Study, name: str) -> list[dict]:
    """Rows by Gauss points per facet edge; none without contact."""
    if study.condition(name).contact is None:
        return []
    # The default rule needs no second run.
    own = Numerics(element_size=study.settings.coarse_size).points_per_edge()
    wanted = [
        study.coarse(name)
        if points == own
        else study.coarse(name, tag=f"-quadrature-{points}", quadrature=points)
        for points in study.settings.quadratures
    ]
    heads = [{"points_per_edge": points} for points in study.settings.quadratures]
    return _compared(study, "convergence, quadrature", name, heads, wanted)


def _ripples(study: Study, scene: Scene) -> list[dict]:
    """Rows by element size, the first with a single Gauss point a facet for comparison; none where
    ``ripple.measure`` gives None."""
    rows = []
    for size, points in (
        (study.settings.coarse_size, 1),
        (study.settings.coarse_size, None),
        (study.settings.element_size, None),
    ):
        numerics = Numerics(element_size=size, quadrature=points)
        if found := ripple.measure(scene, numerics):
            rows.append(
                {
                    "element_size_m": size,
                    "points_per_edge": numerics.points_per_edge(),
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
        board.finished(f"{1e3 * mesh.element_size:g} mm", f"{found['ratio']:,.0f} times")
    return found | {
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
