"""The check of the tolerances by the reference, on the page and for the terminal."""

from tipoff.studies.limits.within import TOGETHER
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Table, percent

_WORDS = {
    "above": "above a limit in the surrogate",
    "near": "at least {near:.0%} of a limit",
    "far": "less than {near:.0%} of every limit",
}


def lines(found: dict) -> list[str]:
    """What the runs of the reference show, in sentences; none where they were not asked for."""
    if found["asked"]["certify"] is None:
        return []
    shown = found["certificate"]
    if shown is None:
        return ["no tolerance of the whole set is certified, so the reference has nothing to check"]
    multiple = next(row for row in found["rows"] if row["name"] == TOGETHER)["nominal"]["tolerance"]
    runs = sum(each["runs"] for each in shown["strata"])
    lines = [
        f"finite elements of {1e3 * shown['element_size_m']:g} mm, {runs} runs at {multiple:.3g} "
        "times the set: a rate is above its limit with a probability of at most "
        f"{percent(shown['upper'])} % ({found['confidence']:.0%} confidence), estimate "
        f"{percent(shown['estimate'])} %; allowed are {percent(1.0 - found['probability'])} %: "
        f"{'certified' if shown['certified'] else 'not certified'}",
        (
            "the same number of runs without strata, none of them above a limit, would give at most "
            f"{percent(shown['plain'])} %"
        ),
    ]
    if not shown["certified"]:
        lines.append(
            "too many cases of the surrogate are above a limit for any number of runs: make the tolerances "
            "smaller"
            if shown["needed"] is None
            else f"{shown['needed']:,} runs would certify it, if no further run is above a limit"
        )
    if shown["lost"]:
        lost = "; ".join(f"{row['run']}: {row['status']} {row['message']}" for row in shown["lost"])
        lines.append(f"not settled in the reference, counted as above: {lost}")
    return lines


def tables(shown: dict | None) -> list[Part]:
    """The strata."""
    if shown is None:
        return []
    rows = [
        (
            _WORDS[each["name"]].format(**shown),
            each["cases"],
            each["runs"],
            each["events"],
            None if each["name"] == "above" else percent(shown[f"{each['name']}_share"]),
        )
        for each in shown["strata"]
    ]
    heads = ("cases", "in the surrogate", "runs of the reference", "above", "at most (%)")
    note = (
        "Cases above a limit in the surrogate count as above. At most: upper bound of the share above in "
        "the reference (Clopper and Pearson); the error probabilities of all bounds add up."
    )
    return [Table(heads, rows, (note,), title="Check by the reference")]
