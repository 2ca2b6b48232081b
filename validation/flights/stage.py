"""The comparison of both launches, its file and its figure."""

from dataclasses import asdict
from pathlib import Path

from tipoff.files import write_json
from tipoff.workspace import machine
from validation.flights import compare, page, record
from validation.flights.compare import Flight
from validation.flights.launchers import LAUNCHERS


def run(records: Path, out: Path, cases: int) -> dict:
    """Compare the records of the folder ``records``; writes into ``out``/flights. Raises SceneError for
    a record that is missing or no table, before the first run."""
    read = [record.read(records, launcher) for launcher in LAUNCHERS]
    folder = out / "flights"
    return written([compare.compared(own, folder, cases) for own in read], folder)


def written(found: list[Flight], folder: Path) -> dict:
    """The comparisons as plain values, in flights.json, with flights.png beside it."""
    page.figure(found, folder / "flights.png")
    return write_json(
        folder / "flights.json",
        {
            "state": machine.state(),
            "flights": [
                {
                    "flight": each.own.launcher.name,
                    "draws": each.count,
                    "lost": each.lost,
                    "rows": [asdict(row) for row in each.rows],
                }
                for each in found
            ],
        },
    )
