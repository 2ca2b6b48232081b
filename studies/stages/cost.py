"""Stage ``cost``: what accuracy costs in time. Error of the settled rates against wall time, both fidelities on one condition; and
how time grows with elements, pads and effects (``studies.scaling``).

The yardstick is the finest finite-element mesh; its own uncertainty is the band below which no error can be told from zero.
The surrogate's time-integration error, against its own tightest tolerance, stands beside its error against the yardstick: what
remains when it is small is the model, and no tolerance can buy it.

``cost.json`` is the bare list of points, ``cost_study.json`` the whole result.
"""

import statistics
from pathlib import Path

from scenes.files import write_json
from scenes.trajectory import Trajectory
from studies import machine
from studies.agreement import verdicts
from studies.agreement.verdicts import FINITE_ELEMENTS
from studies.cost import scaling
from studies.cost.timing import timed, warm_up
from studies.stages import ablation
from studies.stages.compare import Rung, refined, rungs
from studies.store import SOURCES
from studies.study import Study


STIFFNESS_ALONG = "surrogate, stiffness along the rail"  # mean pressure, each face by itself
NAME, POINTS = "cost_study", "cost.json"


def run(study: Study) -> dict:
    """``points``: model, rung, numerics, setting (element size in m or relative tolerance), error_deg_s, wall_s, pareto;
    ``band_deg_s``: uncertainty of the yardstick; ``matched``; ``scaling`` over ``elements``, ``pads`` and ``effects``."""
    name = (study.scene.agreement.refined or study.fitted())[0]
    ladder = surrogates(study)

    def make() -> tuple[dict, list[Path]]:
        finest, band, points = _reference_points(study, name)
        for rung in ladder:
            points += _surrogate_points(study, name, rung, finest)
        growing = {"elements": scaling.elements(study, name), "pads": scaling.pads(study, name),
                   "effects": scaling.effects(study.condition(name), ablation.run(study))}
        path, points = study.path(POINTS), marked(points)
        write_json(path, points)
        return {"condition": name, "scene_hash": study.scene.hash, "band_deg_s": band, "points": points, "matched": matched(points),
                "scaling": growing, "hardware": machine.describe()}, [path]

    return study.stage(NAME, study.key(SOURCES["calibrated"], name, ladder[1].calibration.constants), make)


def surrogates(study: Study) -> list[Rung]:
    """The rungs of the agreement study, and one more between them."""
    plain, calibrated, compliant, modal = rungs(study)
    along = {name: known and known.restricted(1, coupled=False) for name, known in compliant.walls.items()}
    return [plain, calibrated, compliant._replace(name="along", title=STIFFNESS_ALONG, walls=along), compliant, modal]


def _reference_points(study: Study, name: str) -> tuple[Trajectory, float | None, list[dict]]:
    settings = study.settings
    sizes = (2.0 * settings.coarse_size, settings.coarse_size, settings.element_size)
    # The last two are runs of the agreement study, not others under another name.
    asked = [study.highfi(name, element_size=sizes[0], tag="-coarsest"), study.coarse(name), study.highfi(name),
             *refined(study, name).values()]
    coarsest, coarse, finest, *changed = study.store.fill("cost, meshes", asked)
    band = verdicts.largest(verdicts.settled_change(coarse, run) for run in (finest, *changed))
    points = [{"model": FINITE_ELEMENTS, "rung": "highfi", "setting": size,
               "numerics": f"{1e3 * size:g} mm, {found.cost['elements']} elements",
               "error_deg_s": None if found is finest else verdicts.settled_change(finest, found),
               "integration_error_deg_s": None, "wall_s": found.cost["wall_s"], "status": found.status}
              for size, found in zip(sizes, (coarsest, coarse, finest))]
    return finest, band, points


def _surrogate_points(study: Study, name: str, rung: Rung, finest: Trajectory) -> list[dict]:
    tolerances = sorted(study.settings.tolerances)
    asked = [rung.ask(study, name, relative_tolerance=tolerance) for tolerance in tolerances]
    warm_up(asked[0])
    measured = [[timed(run) for _ in range(study.settings.lowfi_repeats)] for run in asked]
    runs = [repeats[0][0] for repeats in measured]
    return [{"model": rung.title, "rung": rung.name, "setting": tolerance, "numerics": f"tolerance {tolerance:g}",
             "error_deg_s": verdicts.settled_change(finest, found),
             "integration_error_deg_s": verdicts.settled_change(runs[0], found) if found is not runs[0] else None,
             "wall_s": statistics.median(wall for _, wall, _ in repeats), "status": found.status}
            for tolerance, found, repeats in reversed(list(zip(tolerances, runs, measured)))]


def matched(points: list[dict]) -> list[dict]:
    """For each surrogate: the cheapest mesh that is as exact, and how many times longer it takes. A surrogate's error is that at
    its tightest tolerance, for errors of the steps may cancel it by luck; its time that of the loosest one that adds no tenth to
    it. The finest mesh, the yardstick, is as exact as anything can be told to be."""
    meshes = [point for point in points if point["model"] == FINITE_ELEMENTS]
    found = []
    for model in dict.fromkeys(point["model"] for point in points if point["model"] != FINITE_ELEMENTS):
        known = [point for point in points if point["model"] == model and point["error_deg_s"] is not None]
        if known:
            error = min(known, key=lambda point: point["setting"])["error_deg_s"]
            enough = [point for point in known if (point["integration_error_deg_s"] or 0.0) <= 0.1 * error]
            point = min(enough, key=lambda point: point["wall_s"])
            as_exact = [mesh for mesh in meshes if (mesh["error_deg_s"] or 0.0) <= error]
            mesh = min(as_exact, key=lambda point: point["wall_s"])
            found.append({"model": model, "numerics": point["numerics"], "error_deg_s": error, "wall_s": point["wall_s"],
                          "mesh": mesh["numerics"], "mesh_error_deg_s": mesh["error_deg_s"], "mesh_wall_s": mesh["wall_s"],
                          "ratio": mesh["wall_s"] / point["wall_s"]})
    return found


def marked(points: list[dict]) -> list[dict]:
    """The points, each told whether no other one is both as exact and as fast (``pareto``)."""
    known = [point for point in points if point["error_deg_s"] is not None]

    def beaten(point: dict) -> bool:
        return any(other is not point and other["error_deg_s"] <= point["error_deg_s"] and other["wall_s"] < point["wall_s"]
                   for other in known)

    return [point | {"pareto": point["error_deg_s"] is not None and not beaten(point)} for point in points]
