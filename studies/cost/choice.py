"""Which model answers a question: the cheapest that reached an accuracy, or the most accurate within a time, as measured.

A point of the cost study counts with its error against the finest mesh and the uncertainty of that mesh, of which the larger is
what it can be trusted to; the finest mesh itself with its uncertainty.
"""

from studies.study import Study, StudyError, read


def choose(study: Study, accuracy: float | None = None, budget: float | None = None) -> dict:
    """The point of ``cost_study.json``, with ``trusted_deg_s`` and ``why`` in words, for an error of the settled rates of at most
    ``accuracy`` (deg/s) and a wall time of at most ``budget`` (s).

    Raises StudyError where nothing was measured for this scene, or where no model fits, with the nearest that does.
    """
    found = read(study.path("cost_study.json"))
    if found is None or found.get("scene_hash") != study.scene.hash:
        raise StudyError(f"no cost was measured for this scene: run tipoff cost --scene {study.scene.name} first")
    points = trusted(found["points"], found["band_deg_s"])
    fit = [point for point in points if _within(point["trusted_deg_s"], accuracy) and _within(point["wall_s"], budget)]
    if not fit:
        raise StudyError(_refusal(points, accuracy, budget))
    by_time, by_error = (lambda p: (p["wall_s"], p["trusted_deg_s"])), (lambda p: (p["trusted_deg_s"], p["wall_s"]))
    best = min(fit, key=by_time if accuracy is not None else by_error)
    reason = "the cheapest that is so exact" if accuracy is not None else "the most exact within the time"
    return best | {"why": f"{words(best)}: {reason}, of {len(points)} measured on {found['condition']}"}


def trusted(points: list[dict], band: float | None) -> list[dict]:
    """The points that have an error, each with what it can be trusted to (deg/s)."""
    known = []
    for point in points:
        error = point["error_deg_s"] if point["error_deg_s"] is not None else band
        if error is not None and point["status"] == "exited":
            known.append(point | {"trusted_deg_s": max(error, band or 0.0)})
    return known


def words(point: dict) -> str:
    """A point in words and units."""
    return f"{point['model']}, {point['numerics']} ({point['trusted_deg_s']:.2g} deg/s, {point['wall_s']:.2g} s)"


def _within(value: float, limit: float | None) -> bool:
    return limit is None or value <= limit


def _refusal(points: list[dict], accuracy: float | None, budget: float | None) -> str:
    asked = " and ".join(filter(None, [accuracy is not None and f"{accuracy:g} deg/s", budget is not None and f"{budget:g} s"]))
    nearest = []
    in_time = [point for point in points if _within(point["wall_s"], budget)]
    exact = [point for point in points if _within(point["trusted_deg_s"], accuracy)]
    if in_time:
        best = min(in_time, key=lambda point: (point["trusted_deg_s"], point["wall_s"]))
        nearest.append(("most exact of all: " if budget is None else "most exact in that time: ") + words(best))
    if exact:
        best = min(exact, key=lambda point: point["wall_s"])
        nearest.append(("fastest of all: " if accuracy is None else "cheapest that is so exact: ") + words(best))
    if not nearest:
        nearest = ["most exact of all: " + words(min(points, key=lambda p: p["trusted_deg_s"])),
                   "fastest of all: " + words(min(points, key=lambda p: p["wall_s"]))] if points else ["no model settled"]
    return f"no model fits {asked}\n  " + "\n  ".join(nearest)
