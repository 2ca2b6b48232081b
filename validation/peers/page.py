"""Comparisons with other codes as tables, and a diagram of work and precision."""

from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from tipoff.files import content_hash
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Heading, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Cells, Column, Table
from tipoff.uncertain import number
from validation.peers import stage
from validation.peers.case import OURS

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page
    from tipoff.workspace.study import Study

_STYLES = (
    (VERMILION, "s"),
    (VERMILION, "D"),
    (TEAL, "^"),
    (AMBER, "s"),
    (AMBER, "D"),
    (GREY, "v"),
)
_EQUAL = 1e-5  # rows with a smaller limit differ only by rounding, printed digits and time steps
_CAPTION = (
    "Error over processor time of one thread. Errors of finite elements are against quadratic ones of "
    "2 mm (rail) and 3 mm (impact), those of rigid bodies against tipoff at a tolerance of 1e-11, "
    "which Exudyn confirms. Exudyn and MuJoCo call Python in every step, for contact and for thrust."
)


def stored(study: "Study") -> dict | None:
    """The results of a folder and their digest, ``key``; None without any."""
    folder = study.folder.parent / "peers"
    if not folder.is_dir():
        return None
    rows = stage.stored(folder)
    return {"peers": rows, "key": content_hash({"peers": rows})}


def draw(page: "Page") -> list[Part]:
    """The section; empty if no peer was run."""
    found = page.results.get("peers")
    return parts(found["peers"]) if found else []


def parts(peers: list[dict]) -> list[Part]:
    """Versions, one table a case, and the diagram."""
    found: list[Part] = [_versions(peers)]
    for peer in peers:
        for case in peer.get("cases", ()):
            found += [Heading(case["title"]), _table(peer, case)]
    chart = picture(peers)
    return (
        [*found, Heading("Work and precision"), Figure(lambda: chart, _CAPTION), equal_error(peers)]
        if chart.panels
        else found
    )


def equal_error(peers: list[dict]) -> Table:
    """Processor time of each code at the smallest error that all codes of a case reach."""
    rows = []
    for case in (case for peer in peers for case in peer.get("cases", ()) if case["work"]):
        codes: dict[str, list[dict]] = {}
        for point in case["work"]:
            codes.setdefault(point["code"], []).append(point)
        reached = max(min(point["error"] for point in points) for points in codes.values())
        for code, points in codes.items():
            # equal elements differ in the last printed digits
            enough = [point for point in points if point["error"] <= 1.001 * reached]
            best = min(enough, key=lambda point: point["cpu_s"])
            # as text, because some errors are below the smallest step of a result
            rows.append(
                (case["error_of"], number(reached, ".2g"), code, best["setting"], best["cpu_s"])
            )
    columns = ("error of", "at most (%)", "code", "setting", Column("CPU", "s"))
    return Table(columns, rows, title="Time at equal error:")


def _versions(peers: list[dict]) -> Table:
    columns: Cells = (
        ("code", "peer"),
        ("kind", lambda peer: peer.get("what", "")),
        ("version", lambda peer: peer.get("version") or f"missing: {peer['missing']}"),
        (
            Column("largest difference with equal models", form=".2g"),
            lambda peer: max((abs(value) for value in _tightest(peer)), default=None),
        ),
    )
    machines = {peer["hardware"]["processor"] for peer in peers if "hardware" in peer}
    note = (
        "A difference is relative to the largest value of its quantity in the table. Equal models: "
        f"the rows whose limit is {_EQUAL:g} or less."
    )
    return Table.of(
        peers, columns, notes=(note, f"Machine: {', '.join(sorted(machines)) or 'none'}.")
    )


def _tightest(peer: dict) -> list[float]:
    """Differences of the rows in which both sides have one model."""
    found = []
    for case in peer.get("cases", ()):
        for row, difference in zip(case["rows"], stage.differences(case["rows"])):
            if row["within"] <= _EQUAL:
                found.append(difference)
    return found


def _table(peer: dict, case: dict) -> Table:
    columns: Cells = (
        ("setting", "setting"),
        ("quantity", "quantity"),
        ("unit", "unit"),
        (Column("tipoff", form=".7g"), "ours"),
        (Column(peer["peer"], form=".7g"), "theirs"),
        (Column("difference", form=".1e"), "difference"),
        (Column("limit", form=".0e"), "within"),
        (Column("tipoff", "CPU s", form=".3g"), "ours_cpu_s"),
        (Column(peer["peer"], "CPU s", form=".3g"), "theirs_cpu_s"),
    )
    rows = [
        {**row, "difference": difference}
        for row, difference in zip(case["rows"], stage.differences(case["rows"]))
    ]
    notes = (
        f"{peer['peer']} {peer['version']}. Matched: {case['matched']}.",
        f"Not matched: {case['unmatched']}.",
        f"Inputs: {', '.join(f'{name} {value}' for name, value in case['inputs'].items())}.",
    )
    return Table.of(rows, columns, notes=notes)


def picture(peers: list[dict]) -> Chart:
    """One panel for each case with points of work and precision."""
    panels, others = [], cycle(_STYLES)
    for peer in peers:
        for case in peer.get("cases", ()):
            codes = list(dict.fromkeys(point["code"] for point in case["work"]))
            lines = []
            for code in codes:
                colour, marker = (NAVY, "o") if code == OURS else next(others)
                points = [point for point in case["work"] if point["code"] == code]
                lines.append(
                    Line(
                        [point["cpu_s"] for point in points],
                        [point["error"] for point in points],
                        name=code,
                        colour=colour,
                        marker=marker,
                        labels=tuple(point["setting"] for point in points),
                    )
                )
            if lines:
                title = case["error_of"]
                panels.append(
                    Panel(title, "CPU time (s)", y_label="error (%)", lines=lines, log=True)
                )
    return Chart("peers", panels, columns=2, height=380)


def figure(peers: list[dict], folder: Path) -> Path:
    """The diagram as a PNG file in ``folder``; its path."""
    from tipoff.studies.render import chart

    made: dict = next((peer["state"] for peer in peers if peer.get("state")), {})
    png, svg = chart.to_files(picture(peers), folder, made)
    svg.unlink()
    return png
