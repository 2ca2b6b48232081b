"""The frames of a run for the terminal."""

from pathlib import Path

from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.view.stage import View


def terminal(found: View, out: Path) -> list[Part]:
    """The largest stress of the run and its place, the frames, the exaggeration, and the files
    below the folder ``out``."""
    own = found.peak
    place = ", ".join(f"{1e3 * value:.4g}" for value in own.place_m)
    cells = (
        ("condition", found.condition),
        (Column("elements", "mm", "g", 1e3), found.element_size_m),
        ("frames", len(found.frames)),
        (Column("peak von Mises", "MPa", ".4g", 1e-6), own.stress_pa),
        ("x, y, z (mm)", place),
        ("rail", own.rail),
        (Column("at", "ms", ".4g", 1e3), own.time_s),
        (Column("exaggeration", form="g"), found.factor),
    )
    columns, row = zip(*cells)
    files = [found.collection, *found.pictures.values()]
    return [
        Table(columns, [row]),
        "\n".join(f"  {out / found.scene / path}" for path in files),
    ]
