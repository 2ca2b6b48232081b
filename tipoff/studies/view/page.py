"""What the terminal shows of the frames of a run."""

from tipoff.studies.render.table import Column, Table


def peak(found: dict) -> Table:
    """The largest stress of the run and where it is, the frames, and the exaggeration."""
    own = found["peak"]
    columns = (
        "condition",
        Column("elements", "mm", "g", 1e3),
        "frames",
        Column("peak von Mises", "MPa", ".4g", 1e-6),
        "x, y, z (mm)",
        "rail",
        Column("at", "ms", ".4g", 1e3),
        Column("exaggeration", form="g"),
    )
    place = ", ".join(f"{1e3 * value:.4g}" for value in own["place_m"])
    row = (
        found["condition"],
        found["element_size_m"],
        len(found["frames"]),
        own["stress_pa"],
        place,
        own["rail"],
        own["time_s"],
        found["factor"],
    )
    return Table(columns, [row])
