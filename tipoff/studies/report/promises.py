"""The promises of the project: for each its limit and the worst value over all stored runs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import NamedTuple

from tipoff.mechanics.promises import FINITE_ELEMENTS, RIGID
from tipoff.studies.agreement import verdicts
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.calibration.stage import Fit
from tipoff.studies.render.table import Table, number
from tipoff.studies.runs.results import ConditionRun
from tipoff.workspace.timing import Speedup
from tipoff.workspace.words import counted


class Promise(NamedTuple):
    """A promise: its text, the worst measured value and its condition, the limit, and whether it is
    kept (None: not measured)."""

    text: str
    worst: str
    limit: str
    kept: bool | None


_WORDS = {
    "linear_momentum_error": "linear momentum of the free system",
    "angular_momentum_error": "angular momentum",
    "quaternion_error": "norm of the quaternions",
    "energy_error": "total energy ledger",
    "transverse_energy_error": "transverse energy ledger",
}
# check, model, limit, words
_CHECKS = tuple(
    (check, fidelity, getattr(promised, check), f"{words}, {model}")
    for check, words in _WORDS.items()
    for fidelity, promised, model in (
        ("highfi", FINITE_ELEMENTS, "finite elements"),
        ("lowfi", RIGID, "surrogate"),
    )
)
_WELL = "no NaN leaves the program; every run ends well"
_ENDED_WELL = ("exited", "jammed")  # a run that reached its time limit has no answer
_NOT_MEASURED = (
    "orders of accuracy are as stated",
    "mirror image, contact order and turned frames give the same answer",
    "same bits for any worker count and after a resume",
)


def promises(
    rows: Mapping[str, Sequence[ConditionRun]],
    agreement: Agreement | None = None,
    calibration: Fit | None = None,
) -> list[Promise]:
    """All promises; ``rows`` are the condition rows of every run by fidelity."""
    found: list[Promise | None] = [
        _check(name, rows[fidelity], limit, words)
        for name, fidelity, limit, words in _CHECKS
        if rows[fidelity]
    ]
    found += [
        _step(rows["highfi"]),
        _surrogate_step(rows["lowfi"]),
        _friction([*rows["highfi"], *rows["lowfi"]]),
        _finite(rows),
    ]
    if agreement:
        found.append(_same_bits(agreement.speedup))
    found.append(_calibration(calibration, agreement))
    return [item for item in found if item] + [
        Promise(words, "not measured by this report", "", None) for words in _NOT_MEASURED
    ]


def _check(name: str, rows: Sequence[ConditionRun], limit: float, words: str) -> Promise:
    worst, where = _worst(rows, name)
    silent = [row.condition for row in rows if row.checks.get(name) is None]
    said = [] if worst is None else [f"{number(worst, '.2g')} ({where})"]
    said += [f"not reported ({', '.join(silent)})"] if silent else []
    return Promise(
        words,
        ", ".join(said),
        f"{limit:g}",
        worst is not None and not silent and worst <= limit,
    )


def _worst(rows: Sequence[ConditionRun], name: str) -> tuple[float | None, str]:
    measured = [
        (row.checks[name], row.condition) for row in rows if row.checks.get(name) is not None
    ]
    # NaN is the worst value
    return max(measured, key=lambda pair: (pair[0] != pair[0], pair)) if measured else (None, "")


def _step(rows: Sequence[ConditionRun]) -> Promise | None:
    measured = [
        (row.cost["dt_s"] / row.cost["dt_limit_s"], row)
        for row in rows
        if row.cost.get("dt_limit_s")
    ]
    if not measured:
        return None
    ratio, row = max(measured, key=lambda pair: pair[0])
    return Promise(
        "no step above the critical one, finite elements",
        f"{1e9 * row.cost['dt_s']:.4g} ns of {1e9 * row.cost['dt_limit_s']:.4g} ns, "
        f"{ratio:.3f} ({row.condition})",
        f"{row.numerics.get('safety', 1.0):g} of the limit",
        ratio <= 1.0,
    )


def _surrogate_step(rows: Sequence[ConditionRun]) -> Promise | None:
    measured = [(row.cost["limit_used"], row.condition) for row in rows if "limit_used" in row.cost]
    if not measured:
        return None
    used, where = max(measured)
    return Promise(
        "no step above the critical one, surrogate",
        f"{used:.3f} of the limit ({where})",
        "1",
        used <= 1.0 + 1e-9,
    )


def _friction(rows: Sequence[ConditionRun]) -> Promise | None:
    worst, where = _worst(rows, "friction_power_max")
    return (
        None
        if worst is None
        else Promise(
            "friction never adds energy",
            f"{number(worst, '.2g')} W ({where})",
            "0 W",
            worst <= 0.0,
        )
    )


def _finite(rows: Mapping[str, Sequence[ConditionRun]]) -> Promise:
    every = [row for found in rows.values() for row in found]
    if not every:
        return Promise(_WELL, "no run", "all", None)
    bad = [row.condition for row in every if row.status not in _ENDED_WELL]
    wild = [row.condition for row in every if not _is_finite(row.settled and asdict(row.settled))]
    statuses = dict.fromkeys(
        f"{row.condition} {row.status}" for row in every if row.status not in _ENDED_WELL
    )
    lost = f", not {', '.join(statuses)}" if bad else ""
    return Promise(
        _WELL,
        f"{len(every) - len(bad)} of {counted(len(every), 'run')} ended well{lost}"
        + (f"; NaN: {', '.join(dict.fromkeys(wild))}" if wild else ""),
        "all",
        not bad and not wild,
    )


def _is_finite(found) -> bool:
    """Whether each number of nested values is finite; None stands for a missing one."""
    if isinstance(found, dict):
        return all(map(_is_finite, found.values()))
    if isinstance(found, (list, tuple)):
        return all(map(_is_finite, found))
    return not isinstance(found, float) or math.isfinite(found)


def _same_bits(speedup: Speedup) -> Promise:
    same = speedup.repeats_identical
    counts = {"reference": speedup.highfi_repeats, "surrogate": speedup.lowfi_repeats}
    compared = [f"{count} {name} runs" for name, count in counts.items() if count > 1]
    words = f"{' and '.join(compared)} compared" if compared else "no repeats to compare"
    return Promise("same input, same bits", words, "identical", same if compared else None)


def _calibration(calibration: Fit | None, agreement: Agreement | None) -> Promise | None:
    if not calibration:
        return None
    held_out = agreement.held_out if agreement else ()
    judged = [row for row in held_out if row.judgement != verdicts.CANNOT]
    informed = bool(calibration.information)
    # no judged condition: no agreement is given; no compared condition: not known
    reported = False if not informed else bool(judged) if held_out else None
    return Promise(
        "calibration reports its information matrix and weak directions; agreement is given on "
        "held-out conditions",
        f"{counted(len(calibration.weak_directions), 'weak direction')} named, "
        f"{len(judged)} of {counted(len(held_out), 'held-out condition')} judged",
        "",
        reported,
    )


def table(found: list[Promise]) -> Table:
    """The table of promises."""
    rows = [
        (
            item.text,
            item.worst,
            item.limit,
            {True: "kept", False: "BROKEN", None: "not measured"}[item.kept],
        )
        for item in found
    ]
    kinds = [{True: "good", False: "bad", None: ""}[item.kept] for item in found]
    return Table(("promise", "worst measured (where)", "limit", ""), rows, kinds=kinds)
