"""Recovery of hidden values on the page and in the terminal."""

from tipoff.studies.calibration.page import constant, interval
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Column, Table, number


def draw(found: dict) -> list[Part]:
    """The section: coverage of the draws, rates of a held-out condition, the reference."""
    asked, held, reference = found["asked"], found["held_out"], found["reference"]
    draws = asked["draws"]
    role = "fitted too" if held["condition"] in found["conditions"] else "held out"
    return [
        Table.of(
            found["rows"],
            (
                ("hidden parameter", lambda row: f"`{row['parameter']}`"),
                (f"inside the 95 % interval, of {draws}", "covered"),
                (f"inside with model error, of {draws}", "covered_with_model_error"),
                ("not determined", "undetermined"),
                (Column("median half width", form=".3g"), "half_width"),
                ("unit", "unit"),
            ),
            notes=(
                f"Curves of the surrogate on {', '.join(found['conditions'])} with "
                f"{100.0 * asked['noise']:g} % of noise, fitted from the scene's values. Settled "
                f"rates of {held['condition']}, which is {role}, are within "
                f"{number(held['fitted_deg_s'], '.2g')} deg/s of those with the hidden values; with "
                f"the scene's values they are off by up to {number(held['scene_deg_s'], '.2g')} "
                "deg/s.",
            ),
        ),
        Table.of(
            reference["rows"],
            (
                ("hidden in the reference", lambda row: f"`{row['parameter']}`"),
                (Column("hidden", form=".4g"), "hidden"),
                (Column("found", form=".4g"), lambda row: constant(row["found"], row["interval"])),
                ("95 % interval with model error", lambda row: interval(row["interval"])),
                ("unit", "unit"),
            ),
            notes=(
                f"One run of the finite elements, {reference['condition']}, in elements of "
                f"{1e3 * reference['element_size_m']:g} mm.",
            ),
        ),
    ]
