"""Stage ``convergence``: the error of the finite-element reference itself, on one condition.

Meshes and steps are refined one after the other, and every quantity is judged by its observed order (``studies.convergence``);
penalty and quadrature, which choose a model rather than approach a limit, are changed and compared. A finer mesh brings a
smaller step with it. A wall of the rail has one element through it at least, so coarse meshes differ in length and width only;
``meshes`` holds the numbers of elements.
"""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Iterator

from highfi.numerics import Numerics
from scenes.trajectory import Trajectory
from studies import agreement, contact_loads
from studies.convergence import estimate
from studies.metrics import AXES
from studies.stages.compare import refinements
from studies.store import SOURCES, Run
from studies.study import Study, read, require_success

NAME = "convergence"
RATE = "settled rate"


def run(study: Study, condition: str | None = None) -> dict:
    """``quantities`` over element size and time step with order and uncertainty, ``penalty``, ``quadrature``, and ``summary`` in
    words. Raises SceneError for an unknown condition, StudyError where a mesh or a step fails."""
    name = condition or (study.scene.agreement.refined or tuple(study.conditions))[0]
    study.condition(name)

    def make() -> tuple[dict, list[Path]]:
        meshes = _finished(study, "convergence, meshes", _meshes(study, name))
        steps = _finished(study, "convergence, steps", _steps(study, name))
        quantities = [*_judged(study, "element size", "m", list(study.settings.mesh_sizes), meshes, study.settings.element_size),
                      *_judged(study, "time step", "s", [found.cost["dt_s"] for found in steps], steps, steps[0].cost["dt_s"])]
        penalty, quadrature = _penalties(study, name), _quadratures(study, name)
        return {"condition": name, "element_size_m": study.settings.element_size, "force_cutoff_hz": contact_loads.cutoff(study.scene),
                "meshes": [{"element_size_m": size, "elements": found.cost["elements"], "dt_s": found.cost["dt_s"],
                            "wall_s": found.cost["wall_s"]} for size, found in zip(study.settings.mesh_sizes, meshes)],
                "quantities": quantities, "penalty": penalty, "quadrature": quadrature,
                "summary": summary(name, quantities, penalty, quadrature)}, []

    return study.stage(NAME, _key(study, name), make)


def stored(study: Study) -> dict | None:
    """The result, if it was made from the present scene, code and settings: the report shows it and makes none."""
    found = read(study.path(f"{NAME}.json"))
    return found if found and found["key"] == _key(study, found["condition"]) else None


def _key(study: Study, name: str) -> str:
    return study.key(SOURCES["highfi"], NAME, name)


def _finished(study: Study, title: str, asked: list[Run]) -> list[Trajectory]:
    runs = study.store.fill(title, asked)
    require_success({item.label: found for item, found in zip(asked, runs)}, "judge the convergence")
    return runs


def _meshes(study: Study, name: str) -> list[Run]:
    """One run a mesh; those that other stages make too keep their name, so that the store has them once."""
    settings = study.settings
    known = {settings.coarse_size: "-coarse", settings.element_size: "", settings.fine_size: refinements(study)["mesh"]["tag"]}
    return [study.highfi(name, element_size=size, tag=known.get(size, f"-{1e3 * size:g}mm")) for size in settings.mesh_sizes]


def _steps(study: Study, name: str) -> list[Run]:
    shared = refinements(study)["step"]
    known = {Numerics().safety: "", shared["safety"]: shared["tag"]}
    return [study.highfi(name, safety=safety, tag=known.get(safety, f"-safety-{safety:g}")) for safety in study.settings.safeties]


def _judged(study: Study, parameter: str, unit: str, sizes: list[float], runs: list[Trajectory], nominal: float) -> list[dict]:
    """One row a quantity. ``nominal_uncertainty`` is that at the ``nominal`` size, with which every other stage runs."""
    rows = []
    for quantity, its_unit, values in quantities_of(study, runs):
        found = estimate(sizes, values)
        at_nominal = values[sizes.index(nominal)]
        rows.append({"quantity": quantity, "unit": its_unit, "parameter": parameter, "sizes": sizes, "size_unit": unit, "values": values,
                     **asdict(found), "nominal_size": nominal,
                     "nominal_uncertainty": None if found.uncertainty is None else found.uncertainty + abs(at_nominal - values[-1])})
    return rows


def quantities_of(study: Study, runs: list[Trajectory]) -> Iterator[tuple[str, str, list[float | None]]]:
    """(quantity, unit, value of each run): what the payload leaves with, and the loads of the pads that touch in any run."""
    for index, axis in enumerate(AXES):
        yield f"{RATE} {axis}", "deg/s", [_entry(found.outcome.rate, index, math.degrees(1.0)) for found in runs]
    yield "settled axial velocity", "m/s", [_entry(found.outcome.velocity, 0) for found in runs]
    impulses = [contact_loads.impulses(study.scene, found) for found in runs]
    for pad in range(len(study.scene.pads)):
        if any(found[pad] for found in impulses):
            yield f"contact impulse, pad {pad + 1}", "N s", [float(found[pad]) for found in impulses]
    if any(found.any() for found in impulses):
        frequency = contact_loads.cutoff(study.scene)
        yield (f"peak contact force below {1e-3 * frequency:g} kHz", "N",
               [contact_loads.filtered_peak(study.scene, found) for found in runs])


def _entry(values: list[float] | None, index: int, factor: float = 1.0) -> float | None:
    return None if values is None else factor * values[index]


def _penalties(study: Study, name: str) -> list[dict]:
    """Rows by penalty stiffness; none without contact."""
    if study.scene.contact is None:
        return []
    stiffness = study.condition(name).contact.penalty
    asked = [study.highfi(name) if factor == 1.0 else study.highfi(name, {"contact.penalty": factor * stiffness}, f"-penalty-{factor:g}")
             for factor in study.settings.penalty_factors]
    heads = [{"factor": factor, "penalty_n_m3": factor * stiffness} for factor in study.settings.penalty_factors]
    return _compared(study, "convergence, penalty", name, heads, asked)


def _quadratures(study: Study, name: str) -> list[dict]:
    """Rows by Gauss points per facet edge; none without contact."""
    if study.scene.contact is None:
        return []
    # The rule that a run takes of its own accord needs no second run.
    own = Numerics(element_size=study.settings.element_size).points_per_edge()
    asked = [study.highfi(name) if points == own else study.highfi(name, tag=f"-quadrature-{points}", quadrature=points)
             for points in study.settings.quadratures]
    return _compared(study, "convergence, quadrature", name, [{"points_per_edge": points} for points in study.settings.quadratures], asked)


def _compared(study: Study, title: str, name: str, heads: list[dict], asked: list[Run]) -> list[dict]:
    """The rows with the settled rates of their runs and the largest change of one (deg/s) against the nominal run."""
    nominal, *runs = study.store.fill(title, [study.highfi(name), *asked])
    return [head | {"status": found.status,
                    "settled_rate_deg_s": [_entry(found.outcome.rate, index, math.degrees(1.0)) for index in range(3)],
                    "settled_rate_change_deg_s": agreement.settled_change(nominal, found)} for head, found in zip(heads, runs)]


def summary(condition: str, quantities: list[dict], penalty: list[dict], quadrature: list[dict]) -> list[str]:
    """What each table says of the settled rates, one line each."""
    lines = []
    for parameter, symbol, factor in (("element size", "mm", 1e3), ("time step", "ns", 1e9)):
        rows = [row for row in quantities if row["parameter"] == parameter and row["quantity"].startswith(RATE)]
        worst = max(rows, key=lambda row: row["nominal_uncertainty"] or 0.0)
        if worst["uncertainty"] is None:
            lines.append(f"{parameter} on {condition}: a run did not settle, so nothing is known of its error")
            continue
        lines.append(f"{parameter} on {condition}: settled rates within {worst['nominal_uncertainty']:.2g} deg/s at the "
                     f"{factor * worst['nominal_size']:.3g} {symbol} of every other stage, within "
                     f"{max(row['uncertainty'] for row in rows):.2g} deg/s at {factor * worst['sizes'][-1]:.3g} {symbol}")
    for title, key, rows in (("penalty stiffness, times", "factor", penalty), ("Gauss points per facet edge,", "points_per_edge", quadrature)):
        if rows:
            change = agreement.largest(row["settled_rate_change_deg_s"] for row in rows)
            odd = "".join(f"; {row[key]:g} {row['status']}" for row in rows if row["settled_rate_change_deg_s"] is None)
            lines.append(f"{title} {rows[0][key]:g} to {rows[-1][key]:g}: "
                         + ("no run settled" if change is None else f"a settled rate changes by up to {change:.2g} deg/s") + odd)
    return lines
