"""The Python interface: scenes, runs in any model, ensembles, calibration, comparison."""

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tipoff import scenes
from tipoff.faults import kind_of
from tipoff.mechanics.model_names import COMPLIANT, FINITE_ELEMENTS, MODELS, SPRINGS, SURROGATES
from tipoff.mechanics.rail_compliance import DEGREE, LOW_DEGREE, MOST_DEGREE, RailCompliance
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import (
    Calibration,
    Fault,
    Scene,
    SceneError,
    arguments,
    reading,
    studies,
)
from tipoff.scenes import catalog as catalog
from tipoff.scenes.arguments import parse as parse

_EXPECTED = {
    "compliance": arguments.kind(
        RailCompliance, "a rail compliance, which tipoff.compliance returns"
    ),
    "calibration": arguments.kind(Calibration, "a calibration, which tipoff.calibrate returns"),
    "progress": arguments.FUNCTION,
    "workers": arguments.whole(1, 1024),
    "store": arguments.PATH,
    "sensitivity": arguments.CHOICE,
    "degree": arguments.whole(LOW_DEGREE, MOST_DEGREE),
    "seed": arguments.whole(0, 2**32 - 1),
    "fit": arguments.NAMES,
}

if TYPE_CHECKING:
    import xarray

    from tipoff.calibration import Curves
    from tipoff.comparison.metrics import Difference


def load(name_or_path: str | Path) -> Scene:
    """Read a scene.

    Args:
        name_or_path: name in the catalogue, or path of a TOML file.

    Returns:
        Scene: the scene.

    Raises:
        SceneError: every fault with file, key, given and expected.

    Warns:
        UserWarning: a value of a file that extends another, if inherited conditions replace the
            value.

    Example:
        >>> scene = tipoff.load("tiny")
        >>> scene.payload.mass  # kg
        9.9
    """
    scene = scenes.load(name_or_path)
    for words in reading.replaced_by_conditions(name_or_path):
        warnings.warn(words, stacklevel=2)
    return scene


def scene_from_rocketpy(flight: Any) -> Scene:
    """The scene of a flight of RocketPy: its rocket on its rail, to compute the tip-off.

    Mass, mass centre and inertia at ignition, buttons, rail, inclination, thrust, its line and that of the
    mass centre are those of the flight; ``provenance`` names the field of each. The profile of the
    rail, its clamps, the material of the buttons and friction are assumed: ``replace`` changes them.

    Args:
        flight: an object of RocketPy's class ``Flight``, that begins on its rail.

    Returns:
        Scene: the scene; ``Trajectory.export`` hands its state at exit back to RocketPy.

    Raises:
        SceneError: every value that the flight lacks.

    Example:
        >>> scene = tipoff.scene_from_rocketpy(flight)  # doctest: +SKIP
        >>> tipoff.run(scene).export("rocketpy", "exit.json")  # doctest: +SKIP
    """
    from tipoff.scenes import from_rocketpy

    return from_rocketpy.scene_of(flight)


def run(
    scene: Scene | str | Path,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    progress: Callable[[float], None] | None = None,
    sensitivity: bool = True,
    **numerics: Any,
) -> Trajectory:
    """Solve a scene in a model.

    Args:
        scene: the scene, or one of its conditions (``Scene.condition``); or a name or path as in
            ``load``.
        model: ``compliant``, ``springs`` or ``finite-elements``.
        compliance: rail compliance, for the model ``compliant``; computed by default.
        calibration: constants that were fitted on the same model.
        progress: called with the completed fraction of the expected time, 0 to 1.
        sensitivity: whether ``checks`` of a surrogate has the changes of the rates (deg/s) by 1 um
            more and less of every clearance and by a tolerance of 1e-10, and ``message`` a warning of
            a change above the limit of the scene's ``[agreement]``; and whether ``error`` has the error
            of the rates by the model (deg/s). The further runs that this takes, about eight, are made
            when one of the three is first used: by its name, ``summary``, ``save``, ``to_xarray`` or
            a notebook.
        numerics: fields of ``lowfi.Numerics`` or ``highfi.Numerics``, such as ``modes=4``, and
            ``element_size=2e-3`` (m) or ``"2 mm"``, of the reference and of the computed rail
            compliance. The scene may state the size of elements (``[studies]``).

    Returns:
        Trajectory: motion over time. A failure of the run is its ``status``.

    Raises:
        SceneError: every fault of scene and options.
        ValueError: numerics that are out of range.

    Example:
        >>> import math
        >>> run = tipoff.run(tipoff.load("tiny").condition("phi15"), modes=0)
        >>> run.status
        'exited'
        >>> [round(math.degrees(rate)) for rate in run.outcome.rate]  # deg/s
        [5, 2, 9]
    """
    from tipoff import highfi, lowfi
    from tipoff.workspace import asked, kernel_marks, model_error
    from tipoff.workspace.run import Run

    scene = arguments.scene_of(scene)
    asked.require_model(scene, model, MODELS)
    if model == FINITE_ELEMENTS:
        arguments.require_none(scene, model, compliance=compliance, calibration=calibration)
    arguments.require(
        _EXPECTED,
        compliance=compliance,
        calibration=calibration,
        progress=progress,
        sensitivity=sensitivity,
    )
    if model == FINITE_ELEMENTS:
        given = {"element_size": studies.element_size(scene.studies, scene.rail.length)} | numerics
        sizes = arguments.numerics(highfi.Numerics, given, lowfi.Numerics, model)
        with kernel_marks.first_use(Run("highfi", scene.name, scene, sizes)):
            return highfi.run(scene, sizes, progress)
    request = asked.run(scene, model, numerics, compliance, calibration)
    with kernel_marks.first_use(request):
        found = lowfi.run(
            scene,
            model,
            compliance=request.compliance,
            calibration=calibration,
            numerics=request.numerics,
            progress=progress,
        )
        if request.compliance is not None:
            found.numerics["rail_compliance"] = request.compliance.stated()
        if not sensitivity:
            return found
        limit = math.degrees(scene.agreement.settled_limit)
        return model_error.told(request, found, limit)


def ensemble(
    scene: Scene | str | Path,
    cases: Any = None,
    model: str = COMPLIANT,
    *,
    compliance: RailCompliance | None = None,
    calibration: Calibration | None = None,
    workers: int | None = None,
    store: str | Path | None = None,
    sensitivity: bool = False,
    **options: Any,
) -> "xarray.Dataset":
    """Run a scene once for each of many cases in a surrogate model.

    Args:
        scene: as in ``run``.
        cases: rows of dotted overrides as in ``Scene.replace``: a list of mappings, a mapping of
            columns, a table of pandas, a data set of xarray or a structured array; or
            distributions, by the name or path of their file. None: the errors that the scene states
            (``studies.errors``), else those of the paper.
        model: ``compliant`` or ``springs``.
        compliance: as in ``run``.
        calibration: as in ``run``.
        workers: number of threads; all cores by default.
        store: folder for results, so that an interrupted ensemble continues.
        sensitivity: add the change of the settled rates of each case (rad/s) for 1 um more of every
            clearance and for a tolerance of 1e-10.
        options: ``count``, ``seed`` and ``sampling``, which replace those of the file of
            distributions, ``element_size`` of the rail compliance, and fields of ``lowfi.Numerics``.
            ``relative_tolerance`` is 1e-2 by default; above 2e-7 a case on compliant contact has fewer
            contact cells and patterns than a run (``lowfi.Numerics.of_many``).

    Returns:
        xarray.Dataset: inputs by their dotted key, and results, with the dimension ``case``; each
        variable has its unit in ``attrs["units"]``. ``attrs["errors"]`` has the range with 95 % of the
        values of each tolerance, of distributions.

    Raises:
        SceneError: every fault of scene, distributions and options.
        StoreError: a ``store`` of another ensemble.
        ValueError: numerics that are out of range.

    Example:
        >>> cases = tipoff.ensemble(tipoff.load("tiny"), "paper", "springs", count=8)
        >>> cases.rate.dims, cases.rate.attrs["units"]
        (('case', 'axis'), 'rad/s')
        >>> tilt = cases["thrust_offset.misalignment.axial"]
        >>> tilt.dims, tilt.attrs["units"]
        (('case',), 'rad')
        >>> heavier = [{"payload.mass": "10 kg"}, {"payload.mass": "11 kg"}]
        >>> tipoff.ensemble(tipoff.load("tiny"), heavier, "springs").sizes["case"]
        2
    """
    from tipoff import lowfi
    from tipoff.workspace import asked, kernel_marks

    scene = arguments.scene_of(scene)
    asked.require_model(scene, model, SURROGATES)
    arguments.require(
        _EXPECTED,
        compliance=compliance,
        calibration=calibration,
        workers=workers,
        store=store,
        sensitivity=sensitivity,
    )
    rows = asked.cases(cases, scene, options)
    like = asked.run(scene, model, options, compliance, calibration, many=True)
    with kernel_marks.first_use(like):
        return lowfi.run_many(
            scene,
            rows,
            model,
            compliance=like.compliance,
            calibration=calibration,
            numerics=like.numerics,
            workers=workers,
            store=store,
            sensitivity=sensitivity,
        )


def compliance(
    scene: Scene | str | Path, element_size: float | str | None = None, degree: int = DEGREE
) -> RailCompliance:
    """Rail compliance under the pads of a scene, from the statics of its finite elements.

    Takes seconds to minutes, once for a rail and its pads. The result is stored in the cache folder
    of the user, with the compiled kernels. A message is printed on standard error.

    Args:
        scene: the scene; only its rail and pads matter.
        element_size: size of the elements (m, or text with a unit); by default that of the
            reference, which the scene may state (``[studies]``).
        degree: of the polynomials of pressure and displacement on a pad face, 2 to 5. A run may
            have a lower one.

    Returns:
        RailCompliance: flexibility and lowest modes at stations along the rail.

    Raises:
        SceneError: every fault.
        MeshError: a rail that cannot be meshed, or that nothing holds.

    Example:
        >>> tipoff.compliance(tipoff.load("tiny"), element_size=8e-3).travel.size
        121
    """
    from tipoff.workspace import asked

    scene = arguments.scene_of(scene)
    size = None if element_size is None else arguments.length("element_size", element_size)
    arguments.require(_EXPECTED, degree=degree)
    return asked.compliance(scene, size, degree)


def calibrate(
    scene: Scene | str | Path,
    references: "Mapping[str, Trajectory | Curves]",
    progress: Callable[[float], None] | None = None,
    seed: int = 0,
    model: str | None = None,
    compliance: RailCompliance | None = None,
    fit: Sequence[str] | None = None,
) -> Calibration:
    """Fit parameters of a surrogate model to runs of the reference or to other curves.

    On compliant contact the parameters are those of ``fit`` (``calibration.choice.every_name``).
    With ``["all"]`` they are all those that the curves determine. By default they are interface and
    mount stiffness, clearance and friction, as far as the curves determine them.

    Args:
        scene: the scene whose conditions the curves belong to.
        references: runs of the reference, or ``calibration.Curves``, by the name of their condition.
        progress: called with the completed fraction, 0 to 1.
        seed: of the search.
        model: ``springs`` (default), or ``compliant`` (default with ``fit``).
        compliance: as in ``run``.
        fit: names of parameters of compliant contact.

    Returns:
        Calibration: values with their intervals; ``run`` and ``ensemble`` take it.

    Raises:
        CalibrationError: curves that determine nothing.
        SceneError: every fault.

    Example:
        >>> scene = tipoff.load("tiny")
        >>> names = scene.agreement.fitted
        >>> curves = {name: tipoff.run(scene.condition(name), modes=0) for name in names}
        >>> found = tipoff.calibrate(scene, curves, fit=["friction.dynamic"])
        >>> round(found.values[0], 2)  # that of the curves
        0.2
    """
    from tipoff import calibration
    from tipoff.lowfi import models
    from tipoff.workspace import asked

    scene = arguments.scene_of(scene)
    if model is None:
        model = SPRINGS if fit is None else COMPLIANT
    asked.require_model(scene, model, SURROGATES)
    arguments.require(_EXPECTED, progress=progress, seed=seed, compliance=compliance, fit=fit)
    seed = arguments.plain(seed)
    calibration.require_model(scene, model, fit)
    found = asked.walls(scene, model, compliance)
    models.require(scene, model, found, None, None)
    return calibration.run(
        scene,
        references,
        progress=progress,
        plan=calibration.Plan(seed=seed),
        compliance=found,
        fit=fit,
    )


def compare(reference: "Trajectory | Curves", surrogate: "Trajectory | Curves") -> "Difference":
    """Differences of a surrogate from the reference in all metrics of the agreement table.

    Args:
        reference: a run, or ``calibration.Curves`` of a file.
        surrogate: another run of the same condition, or curves.

    Returns:
        Difference: relative L2 differences, settled differences (deg/s, m/s, deg), ratings.

    Example:
        >>> scene = tipoff.load("tiny")
        >>> ours, other = tipoff.run(scene, modes=0), tipoff.run(scene, "springs")
        >>> tipoff.compare(ours, ours).settled_rate_error_deg_s
        0.0
        >>> tipoff.compare(ours, other).settled_rate_error_deg_s > 0.1
        True
    """
    from tipoff.comparison import metrics
    from tipoff.comparison.curves import Curves

    for name, given in (("reference", reference), ("surrogate", surrogate)):
        if not isinstance(given, (Trajectory, Curves)):
            expected = "a Trajectory, which tipoff.run returns, or Curves"
            raise SceneError([Fault("arguments", name, kind_of(given), expected)])
    return metrics.compare(reference, surrogate)
