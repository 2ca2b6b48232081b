"""What the terminal shows of the frames of a run."""

from tipoff.studies.render.table import Column, Table


def peak(found: dict) -> Table:
    """The largest stress of the run and where it is, the frames, and the exaggeration."""
    own = found["peak"]
    place = ", ".join(f"{1e3 * value:.4g}" for value in own["place_m"])
    cells = (
        ("condition", found["condition"]),
        (Column("elements", "mm", "g", 1e3), found["element_size_m"]),
        ("frames", len(found["frames"])),
        (Column("peak von Mises", "MPa", ".4g", 1e-6), own["stress_pa"]),
        ("x, y, z (mm)", place),
        ("rail", own["rail"]),
        (Column("at", "ms", ".4g", 1e3), own["time_s"]),
        (Column("exaggeration", form="g"), found["factor"]),
    )
    columns, row = zip(*cells)
    return Table(columns, [row])
