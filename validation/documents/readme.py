"""Writes the figures of README.md, docs/results.md, docs/tails.md, their pictures, and the distributions in the
tutorials from the result files of ``make full-report``.

    python -m validation.documents.readme [FOLDER]

The result files that these pages show are kept in ``validation/documents/kept``. With the FOLDER of a scene's
results, such as out/reference, those that it has, and those beside it, replace the kept ones first. So a part can
be made again alone, and each states its own version, commit, day and machine. Without a FOLDER the pages are
written again from what is kept, after an edit of their words.
"""

import json
import re
import shutil
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from operator import attrgetter
from pathlib import Path
from tempfile import TemporaryDirectory

from tipoff.files import read_json, write_text
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.studies.agreement import growth_page, other_rails, verdicts
from tipoff.studies.agreement import stage as compare
from tipoff.studies.agreement.equal_accuracy import EqualAccuracy
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.agreement.page import by_factor
from tipoff.studies.agreement.stage import Agreement
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.studies.blind import stage as blind_study
from tipoff.studies.blind.stage import Blind
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.cost import page as cost_page
from tipoff.studies.cost import stage as cost_study
from tipoff.studies.cost.results import Cost
from tipoff.studies.render import chart
from tipoff.studies.render.chart import Chart, Picture
from tipoff.studies.render.document import Part, markdown
from tipoff.studies.render.table import Column, Table, number, percent
from tipoff.uncertain import STEPS
from tipoff.workspace.study import read
from tipoff.workspace.timing import Speedup
from validation.documents import further, state
from validation.montecarlo import tails as checked
from validation.montecarlo import tails_page
from validation.montecarlo.results import Tails

_ROOT = Path(__file__).resolve().parents[2]
KEPT = Path(__file__).parent / "kept"
_SCENE = "reference"
_RAILS = ("thin", "titanium")
_LAUNCHERS = {"cubesat_3u": "deployer"}  # scenes whose distributions a tutorial shows, and its name
_TITLE = """# Results on the reference scene

Written by `python -m validation.documents.readme` from the kept files of `make full-report`. Times
of different tables may be from different days, so do not divide them by each other. The
[glossary](glossary.md) has the terms, and [agreement](explanation/convergence_and_chaos.md) the limits.

Conditions `phi0` to `phi90` are those of the paper: 0.1 deg of thrust misalignment at this clock angle. The
springs were fitted to them, and not to `h1` to `h10`. No pad touches a rail in `h5` and `h6`: their agreement
tests free flight."""
_FIGURE = """![Velocity and body rates over time of all models](figure6.png)

*Axial velocity (a), and body rates on five conditions (b to f). Compliant contact (thin lines) agrees with the
finite elements (broad lines). The rates of springs are wrong after an impact (dashed: calibrated, dotted:
uncalibrated).*"""
_TAILS = """# Random errors checked by the reference

Scene {scene}. Written by `python -m validation.documents.readme` from the file of
`python -m validation montecarlo --cases {cases} --reference {draws} --finer {fine}`. All runs of the surrogate have the
[number of rail modes](rail_modes.md#one-number-in-a-study) that pilot cases of the population chose. The
table by settings has runs with others too."""
# The result files on the page of results, beside those of ``make bench``.
_ON_PAGE = (
    "highfi",
    "lowfi",
    "agreement",
    "blind",
    "convergence",
    "ripple",
    "cost_study",
    "scaling",
)


# Result files that pages show, in the folder of all results.
_SHOWN = (
    *(f"{_SCENE}/{name}.json" for name in (*_ON_PAGE, "tails")),
    *(f"{rail}/{name}.json" for rail in _RAILS for name in ("agreement", "calibration")),
    *(f"{scene}/agreement.json" for scene in _LAUNCHERS),
    *(f"bench/{name}.json" for name in ("highfi", "lowfi")),
)


def main(folder: Path | None = None) -> None:
    """Replace the pages and the pictures beside them; the results in ``folder`` and beside it are kept first."""
    if folder is not None:
        keep(folder.parent)
        if (picture := folder / "figures" / "figure6.png").is_file():
            shutil.copyfile(picture, _ROOT / "docs" / picture.name)
    for path, text in texts().items():
        write_text(path, text)
    for shown, made in _pictures(KEPT / _SCENE):
        with TemporaryDirectory() as drawn:
            (picture, *_) = chart.to_files(shown, Path(drawn), made)
            shutil.copyfile(picture, _ROOT / "docs" / picture.name)


def keep(results: Path) -> None:
    """Copy the result files that pages show from the folder of all ``results``; one that it lacks stays as it
    is."""
    for name in _SHOWN:
        if (found := read(results / name)) is not None:
            (KEPT / name).parent.mkdir(parents=True, exist_ok=True)
            write_text(KEPT / name, f"{json.dumps(found, separators=(',', ':'))}\n")


def texts() -> dict[Path, str]:
    """The pages that are written from the kept results, by their paths."""
    folder = KEPT / _SCENE
    start = (_ROOT / "README.md").read_text(encoding="utf-8")
    start = _into(start, "results", read_json(folder / "agreement.json"), headline(folder))
    made_by = state.sentence({name: read(folder / f"{name}.json") for name in _ON_PAGE})
    found = {
        _ROOT / "docs" / "results.md": (
            f"{_TITLE}\n\n{made_by}\n\n{section(folder)}\n\n{further.details(folder)}\n"
        )
    }
    if (document := read(folder / "tails.json")) is not None:
        tails = checked.STAGE.read(document)
        said = [f"{_upper(each)}." for each in tails_page.brief(tails)]
        lines = "\n  - ".join(["- **Tails**, from [random ejections](docs/tails.md):", *said])
        start = _into(start, "tails", document, lines)
        found[_ROOT / "docs" / "tails.md"] = _of_tails(tails, document)
    for scene, name in _LAUNCHERS.items():
        if (document := read(KEPT / scene / "agreement.json")) is not None:
            page = _ROOT / "docs" / "tutorials" / f"{name}.md"
            own = further.quantiles(compare.STAGE.read(document).distributions)
            lines = markdown([own, state.sentence({"agreement": document})])
            found[page] = _into(
                page.read_text(encoding="utf-8"), "distributions", document, f"\n{lines}\n"
            )
    return found | {_ROOT / "README.md": start}


def _of_tails(found: Tails, document: dict) -> str:
    """The page of random errors checked by the reference."""
    head = _TAILS.format(scene=f"`{_SCENE}`", **vars(found))
    made_by = state.sentence({"tails": document})
    return f"{head}\n\n{made_by}\n\n{markdown(tails_page.document(found))}\n"


def _pictures(folder: Path) -> Iterator[tuple[Chart | Picture, dict]]:
    """Pictures drawn from results in ``folder``, and the state of their numbers."""
    if (cost := read(folder / "cost_study.json")) is not None:
        yield cost_page.picture(cost_study.STAGE.read(cost)), cost.get("state") or {}
    if (document := read(folder / "tails.json")) is not None:
        for drawn in tails_page.figures(checked.STAGE.read(document)):
            yield drawn.chart, document.get("state") or {}


def _into(text: str, name: str, document: dict, lines: str) -> str:
    """The ``text`` of a page with ``lines`` on a result file's ``document`` between the marks of ``name``."""
    end = f"<!-- end of {name} -->"
    before, rest = re.split(f"<!-- {name}[,:].*-->", text, maxsplit=1)
    return f"{before}{state.mark(name, document)}\n{lines}\n{end}{rest.split(end)[1]}"


def headline(folder: Path) -> str:
    """The figures of README: agreement of compliant contact, its speed-up in equal elements, and that
    at equal accuracy if the error of the reference was studied."""
    agreement = _compared(folder)
    faster = _faster(agreement.speedup_compliant)
    fast = f"- **Speed** on equal elements: {faster}."
    if (equal := _equal(folder)) is not None:
        fast += f" {equal.short()}."
    return f"{_agreed(agreement.compliant)}\n{fast}"


def _compared(folder: Path) -> Agreement:
    return compare.STAGE.read(read_json(folder / "agreement.json"))


def _agreed(rows: Sequence[JudgedCondition]) -> str:
    """How many conditions are judged and agree, and the errors where pads touch."""
    curves = [row for row in rows if row.judged_as == verdicts.CURVE]
    judged = [row for row in curves if row.judgement != verdicts.CANNOT]
    agree = [row for row in judged if row.judgement == verdicts.AGREES]
    touched = [row for row in agree if row.touches]
    said = (
        f"- **Agreement**: The reference is converged on {len(judged)} of {len(rows)} conditions. "
        f"Compliant contact has no fitted constants and agrees on {len(agree)} of these {len(judged)}."
    )
    if touched:
        rates, settled = (
            verdicts.largest(getattr(row, name) for row in touched)
            for name in ("rate_relative_l2", "settled_rate_error_deg_s")
        )
        said += (
            f"\n  - Pads touch in {len(touched)} of the {len(agree)}. There the rates differ by at most "
            f"{percent(rates, '.2g')} % over time (L2), and the settled rates by at most "
            f"{number(settled, '.2g')} deg/s."
        )
    if others := [row for row in rows if row.judged_as == verdicts.DISTRIBUTION]:
        count = Counter(row.judgement for row in others)
        said += (
            f"\n  - On {len(others)} others, [distributions](docs/chaotic_conditions.md) of the settled rates "
            f"are compared: {count[verdicts.AS_DISTRIBUTION]} agree, {count[verdicts.MISSES]} miss, "
            f"{count[verdicts.CANNOT]} cannot be judged."
        )
    return said


def _upper(sentence: str) -> str:
    return sentence[0].upper() + sentence[1:]


def section(folder: Path) -> str:
    """Markdown of the results: agreement, speed-up, other rails, time against accuracy."""
    agreement = _compared(folder)
    cost, blind = (read(folder / f"{name}.json") for name in ("cost_study", "blind"))
    parts: list[Part] = [
        _agreement(agreement),
        _FIGURE,
        *([by_factor(agreement.interface)] if agreement.interface else []),
        *_growth(agreement.growth),
        _speed(agreement),
    ]
    if (equal := _equal(folder)) is not None:
        parts.append(f"{_upper(equal.sentence())} (`make convergence`).")
    parts += [_rails(found)] if (found := list(_other_rails(folder.parent))) else []
    parts += [_blind(blind_study.STAGE.read(blind))] if blind is not None else []
    parts += _ladder(cost_study.STAGE.read(cost)) if cost is not None else []
    return markdown(parts)


def _pair(row: JudgedCondition) -> str:
    return (
        f"{percent(row.rate_relative_l2, '.2g')} / "
        f"{number(row.settled_rate_error_deg_s, '.2g', STEPS['deg/s'])}"
    )


_COMPLIANT: tuple = (
    ("compliant contact", _pair),
    "floor_deg_s",
    (
        Column("reference uncertainty", "deg/s", ".2g"),
        attrgetter("reference_uncertainty_deg_s"),
    ),
    *("judged_as", "verdict"),
)


def _of(rows: Sequence[JudgedCondition]) -> Callable[[JudgedCondition], str]:
    """A cell with the errors of another model on the same condition."""
    own = {row.condition: _pair(row) for row in rows}
    return lambda row: own[row.condition]


def _agreement(found: Agreement) -> Table:
    return Table.of_records(
        found.compliant,
        "condition",
        ("role", lambda row: row.role.replace("_", " ")),
        ("springs, uncalibrated", _of(found.uncalibrated)),
        ("springs, calibrated", _of(found.calibrated)),
        *_COMPLIANT,
        title="Errors of the surrogates against the reference (rate L2 in % / largest error of "
        "a settled rate in deg/s), the floor, and the\nuncertainty of the reference. "
        "Compliant contact has no fitted constants; the role is that of the condition in "
        "the calibration of springs.\nThe verdict is that of compliant contact.",
    )


def _growth(found: Sequence[Growth]) -> list[Part]:
    """A line for each condition in which 1 µm changes a rate by more than the gate, and one line
    for all others; empty if not measured."""
    own = [item for item in found if item.model == FINITE_ELEMENTS]
    stable = [item for item in own if item.sensitive is False]
    lines = [
        f"- {growth_page.sentence(item)} "
        f"({number(item.settled_growth_deg_s_um, '.2g', STEPS['deg/s'])} deg/s per µm)"
        for item in own
        if item.sensitive is not False
    ]
    if stable:
        most = verdicts.largest(item.settled_growth_deg_s_um for item in stable)
        names = ", ".join(item.condition for item in stable)
        lines.append(
            f"- {names}: stable to the end (up to {number(most, '.2g', STEPS['deg/s'])} deg/s per µm)"
        )
    return (
        ["Growth of a difference of 1 µm of clearance in the reference:", "\n".join(lines)]
        if lines
        else []
    )


def _speed(agreement: Agreement) -> str:
    plain, machine = agreement.speedup, agreement.speedup_compliant.hardware
    compliant = agreement.speedup_compliant
    return (
        f"Speed: {_faster(compliant)} ({compliant.low:,.0f} to {compliant.high:,.0f} over "
        f"repeats); {plain.ratio:,.0f} times "
        f"({1e3 * plain.lowfi_wall_s:.3g} ms) for springs, calibrated. The same case, everything but "
        f"compilation included, on {machine['cores']} cores of {machine['processor']}."
    )


def _faster(found: Speedup) -> str:
    return (
        f"{found.ratio:,.0f} times on {found.condition}, medians of alternating runs: "
        f"{found.highfi_wall_s:.3g} s for the reference with {found.elements:,} "
        f"elements against {1e3 * found.lowfi_wall_s:.3g} ms on compliant contact"
    )


def _equal(folder: Path) -> EqualAccuracy | None:
    """The speed-up on the mesh whose uncertainty is as small as the error of the surrogate; None if not
    measured."""
    found = read(folder / "convergence.json")
    return None if found is None else convergence.STAGE.read(found).equal_accuracy


def _other_rails(results: Path) -> Iterator[other_rails.Scene]:
    for rail in _RAILS:
        agreement, own = (
            read(results / rail / f"{name}.json") for name in ("agreement", "calibration")
        )
        if agreement is not None and own is not None:
            yield other_rails.Scene(rail, compare.STAGE.read(agreement), dict(own["constants"]))


def _rails(found: Sequence[other_rails.Scene]) -> Table:
    title = "Other rails, each with its own calibration (`make rails`):"
    return other_rails.table(found, title=title)


def _blind(found: Blind) -> Table:
    """Conditions drawn after all code was written, in the form of the agreement table."""
    return Table.of_records(
        found.compliant,
        "condition",
        ("springs, calibrated", _of(found.calibrated)),
        *_COMPLIANT,
        title=f"{len(found.compliant)} random conditions with errors as in the paper's Table 3 (`make "
        "blind`; other code draws other conditions):",
    )


def _ladder(found: Cost) -> list[Part]:
    rows = []
    for point in found.points:
        wall = point.wall_s
        errors = [
            "reference" if point.reference else value if value is None else scale * value
            for value, scale in ((point.error_deg_s, 1.0), (point.curve_error, 100.0))
        ]
        time = f"{wall:.3g} s" if wall >= 0.1 else f"{1e3 * wall:.2g} ms"
        rows.append((point.model, point.numerics, time, *errors))
    heads = (
        "model",
        "numerics",
        "wall time",
        Column("settled rates", "deg/s", ".2g"),
        Column("rate L2", "%", ".2g"),
    )
    return [
        f"Error and time of all models (`make cost`, {found.condition}). Errors are relative "
        f"to the finest mesh, whose own uncertainty is {number(found.band_deg_s, '.2g')} "
        "deg/s; smaller errors count as this value. Bold: no faster model is as accurate.",
        "![Errors of all models against wall time](cost.png)",
        Table(heads, rows, kinds=["best" if point.pareto else "" for point in found.points]),
    ]


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
