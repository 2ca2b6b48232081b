"""Writes the figures of README.md and docs/results.md from the result files of ``make
full-report``, so that no number in them is typed by hand.

    python -m tipoff.studies.report.readme [FOLDER]        default out/reference
"""

import shutil
import sys
from pathlib import Path

from tipoff.files import read_json, write_text
from tipoff.mechanics.models import COMPLIANT, FINITE_ELEMENTS
from tipoff.studies.agreement import growth_page, rails_page
from tipoff.studies.agreement.verdicts import CONVERGED_DEG_S
from tipoff.studies.bench import reference
from tipoff.studies.convergence import equal_accuracy
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.core.study import read
from tipoff.studies.cost import scaling_page
from tipoff.studies.report.stage import beside

_ROOT = Path(__file__).resolve().parents[3]
_TITLE = """# Further results on the reference scene

Written by `python -m tipoff.studies.report.readme` from the files of `make full-report` and `make bench`; times
of different tables may be those of different days and are not to be divided by each other. Terms
are those of README."""
_BEGIN, _END = "<!-- results: python -m tipoff.studies.report.readme -->", "<!-- end of results -->"


def main(folder: Path) -> None:
    """Replace the results section of README.md, the page of further results, and the pictures
    beside it."""
    readme = _ROOT / "README.md"
    before, rest = readme.read_text().split(_BEGIN)
    after = rest.split(_END)[1]
    write_text(readme, f"{before}{_BEGIN}\n{section(folder)}\n{_END}{after}")
    (_ROOT / "docs").mkdir(exist_ok=True)
    write_text(_ROOT / "docs" / "results.md", f"{_TITLE}\n\n{details(folder)}\n")
    for name in ("figure6.png", "cost.png"):
        shutil.copyfile(folder / "figures" / name, _ROOT / "docs" / name)


def section(folder: Path) -> str:
    """Markdown of what was found: agreement, speed-up, other rails, and what accuracy costs."""
    agreement = read_json(folder / "agreement.json")
    refined, cost = (read(folder / f"{name}.json") for name in ("convergence", "cost_study"))
    parts = [
        _agreement(agreement),
        *_stiffer(agreement["stiffer"]),
        *_growth(agreement["growth"]),
        _speed(agreement),
        *_equal(refined, cost),
    ]
    parts += [_rails(found)] if (found := beside(folder)) else []
    parts += [_blind(blind)] if (blind := read(folder / "blind.json")) is not None else []
    parts += [_ladder(cost)] if cost is not None else []
    return "\n\n".join(parts)


def details(folder: Path) -> str:
    """Markdown of the rest: kept promises, what a mesh costs, the error of the reference itself,
    and speeds."""
    highfi, lowfi = (read_json(folder / f"{name}.json") for name in ("highfi", "lowfi"))
    refined, cost = (read(folder / f"{name}.json") for name in ("convergence", "cost_study"))
    parts = [_promises(highfi, lowfi)]
    parts += [_cost(cost), _scaling(cost["scaling"])] if cost is not None else []
    parts += [_convergence(refined)] if refined is not None else []
    if (found := reference.stored(folder.parent)) is not None:
        parts += [_bench(found["rows"])] if found["rows"] else []
        parts += [_surrogate(found["lowfi"])] if found["lowfi"] else []
    return "\n\n".join(parts)


def _agreement(found: dict) -> str:
    before = {row["condition"]: row for row in found["uncalibrated"]}
    fitted = {row["condition"]: row for row in found["fitted"] + found["held_out"]}
    lines = [
        "Rates of the surrogates against the reference (rate L2 in % / largest error of a settled "
        "rate in deg/s), and what "
        "bounds any",
        "such claim. Nothing is fitted on compliant contact; the role is that of the condition in "
        "the calibration of the "
        "springs.",
        "The verdict is on compliant contact.",
        "",
        "| condition | role | springs, uncalibrated | springs, calibrated | compliant contact | "
        "floor, deg/s | "
        "reference uncertainty, deg/s | verdict |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in found["compliant"]:
        lines.append(
            f"| {row['condition']} | {row['role'].replace('_', ' ')} | "
            f"{_pair(before[row['condition']])} | "
            f"{_pair(fitted[row['condition']])} | {_pair(row)} | {_number(row['floor_deg_s'])} | "
            f"{_number(row['reference_uncertainty_deg_s'])} | {row['verdict']} |"
        )
    return "\n".join(lines)


def _stiffer(found: list[dict]) -> list[str]:
    """How the models move together where the penalty, which both share, is what the reference is
    not sure of."""
    moved = [row for row in found if (row["reference_change_deg_s"] or 0.0) > CONVERGED_DEG_S]
    lines = [
        f"- {row['condition']}: the reference moves by {_number(row['reference_change_deg_s'])} "
        f"deg/s, the surrogate by "
        f"{_number(row['surrogate_change_deg_s'])}; {_number(row['apart_deg_s'])} apart before, "
        f"{_number(row['apart_with_more_deg_s'])} after"
        for row in moved
    ]
    return (
        [
            "Where four times the penalty alone takes the reference's convergence, on the coarse "
            "mesh, and the surrogate on "
            "compliant contact with\nthe same penalty:\n\n" + "\n".join(lines)
        ]
        if lines
        else []
    )


def _blind(found: dict) -> str:
    """Conditions drawn after all code was written, as the agreement table has the scene's own."""
    springs = {row["condition"]: row for row in found["calibrated"]}
    lines = [
        f"{len(springs)} conditions drawn afterwards, with errors as in the paper's Table 3 (`make "
        f"blind`; another line of "
        "code draws others):",
        "",
        "| condition | springs, calibrated | compliant contact | floor, deg/s | reference "
        "uncertainty, deg/s | verdict |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row['condition']} | {_pair(springs[row['condition']])} | {_pair(row)} | "
        f"{_number(row['floor_deg_s'])} | "
        f"{_number(row['reference_uncertainty_deg_s'])} | {row['verdict']} |"
        for row in found["compliant"]
    ]
    return "\n".join(lines)


def _pair(row: dict) -> str:
    curve = row["rate_relative_l2"]
    return (
        f"{_number(None if curve is None else 100.0 * curve)} / "
        f"{_number(row['settled_rate_error_deg_s'])}"
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


def _speed(agreement: dict) -> str:
    found, plain = agreement["speedup_compliant"], agreement["speedup"]
    machine = found["hardware"]
    return (
        f"Speed: {found['ratio']:,.0f} times ({found['low']:,.0f} to {found['high']:,.0f} over "
        f"repeats): "
        f"{found['highfi_wall_s']:.3g} s for the reference with {found['elements']:,} elements "
        f"against "
        f"{1e3 * found['lowfi_wall_s']:.3g} ms on compliant contact; {plain['ratio']:,.0f} times "
        f"({1e3 * plain['lowfi_wall_s']:.3g} ms) for springs, calibrated. The same case, "
        f"everything but compilation "
        f"included, on {machine['cores']} cores of {machine['processor']}."
    )


def _equal(refined: dict | None, cost: dict | None) -> list[str]:
    """The speed-up on the mesh that is as sure as the surrogate is exact, where the error of the
    reference was studied; and on the mesh that is as near, where cost was."""
    if refined is None or refined["equal_accuracy"] is None:
        return []
    said = equal_accuracy.sentence(refined["equal_accuracy"])
    near = [
        f"\nWhat equal accuracy means decides: by its distance from the finest mesh of the cost "
        f"table, whatever that is itself "
        f"sure of,\n{row['mesh'].split(',')[0]} would do, {row['ratio']:,.0f} times. The mesh of "
        f"the paragraph above is the "
        "one that every other table stands on."
        for row in (cost["matched"] if cost else ())
        if row["model"] == COMPLIANT
    ]
    return [f"{said[0].upper()}{said[1:]} (`make convergence`)." + "".join(near)]


def _rails(found: list[dict]) -> str:
    lines = [
        "Other rails, each calibrated and judged by itself (`make rails`):",
        "",
        f"| {' | '.join(rails_page.HEADS)} |",
        "|---" * len(rails_page.HEADS) + "|",
    ]
    return "\n".join(
        [*lines, *(f"| {' | '.join(map(str, row))} |" for row in rails_page.rows(found))]
    )


def _ladder(found: dict) -> str:
    band = found["band_deg_s"]
    lines = [
        f"What accuracy costs in time (`make cost`, {found['condition']}): errors against the "
        f"finest mesh, whose own "
        f"uncertainty is {_number(band)} deg/s; smaller ones count as that. Bold: none faster is "
        f"as good.",
        "",
        "![Errors of all models against wall time](docs/cost.png)",
        "",
        "| model | numerics | wall time | settled rates, deg/s | rate L2, % |",
        "|---|---|---|---|---|",
    ]
    for point in found["points"]:
        mark = "**" if point["pareto"] else ""
        wall = point["wall_s"]
        errors = [
            "the yardstick" if value is None else _number(factor * value)
            for value, factor in ((point["error_deg_s"], 1.0), (point["curve_error"], 100.0))
        ]
        lines.append(
            f"| {mark}{point['model']}{mark} | {point['numerics']} | "
            f"{f'{wall:.3g} s' if wall >= 1.0 else f'{1e3 * wall:.2g} ms'} | {' | '.join(errors)} |"
        )
    return "\n".join(lines)


def _cost(found: dict) -> str:
    lines = [
        f"What the same accuracy costs (`make cost`, {found['condition']}): each surrogate, "
        "and the coarsest mesh that is no less exact.",
        "",
        "| model | error, deg/s | wall time, ms | mesh | its error, deg/s | wall time, s | times "
        "as long |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in found["matched"]:
        exact = (
            "the yardstick" if row["mesh_error_deg_s"] is None else _number(row["mesh_error_deg_s"])
        )
        lines.append(
            f"| {row['model']}, {row['numerics']} | {_number(row['error_deg_s'])} | "
            f"{1e3 * row['wall_s']:.2g} | "
            f"{row['mesh']} | {exact} | {row['mesh_wall_s']:.3g} | {row['ratio']:,.0f} |"
        )
    return "\n".join(lines)


def _growth(found: list[dict]) -> list[str]:
    """One line a condition that 1 µm moves by more than the gate, and one for all others; nothing
    where it was not measured."""
    own = [item for item in found if item["model"] == FINITE_ELEMENTS]
    stable = [item for item in own if item["sensitive"] is False]
    lines = [
        f"- {growth_page.sentence(item)} ({_number(item['settled_growth_deg_s_um'])} deg/s per µm)"
        for item in own
        if item["sensitive"] is not False
    ]
    if stable:
        most = max(item["settled_growth_deg_s_um"] for item in stable)
        names = ", ".join(item["condition"] for item in stable)
        lines.append(f"- {names}: stable to the end (up to {_number(most)} deg/s per µm)")
    return (
        ["\n".join(["How 1 µm of clearance grows in the reference:", "", *lines])] if lines else []
    )


def _scaling(found: dict) -> str:
    """Exponents over elements and pads, and what all effects cost over none."""
    over = found["elements"]
    laws = [
        (f"{_ends(over)} elements", over),
        ("the two finest meshes", over["finest"] | {"model": over["model"]}),
        *((f"{_ends(law)} pads", law) for law in found["pads"]),
    ]
    lines = [
        "How time grows (`make cost`, one processor): t = c n^p. Expected over elements: 1 for a "
        "step, 4/3 for a run, "
        "whose steps",
        "shorten too.",
        "",
        "| over | model | p of a run | p of a step |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {words} | {law['model']} | {scaling_page.exponent(law['run'])} | "
        f"{scaling_page.exponent(law['step'])} |"
        for words, law in laws
    ]
    prices = "; ".join(f"{item['model']} {item['ratio']:.2f} times" for item in found["effects"])
    step = (
        ""
        if over["fixed_s"] is None
        else (
            f"A step of the reference takes {1e6 * over['fixed_s']:.2g} µs on any mesh and "
            f"{1e9 * over['element_s']:.2g} ns for each element. "
        )
    )
    return "\n".join([*lines, "", f"{step}All effects over none take: {prices}."])


def _ends(law: dict) -> str:
    return f"{law['points'][0]['n']:,} to {law['points'][-1]['n']:,}"


def _convergence(found: dict) -> str:
    sizes = [row for row in found["quantities"] if row["parameter"] == "element size"]
    heads = [f"{1e3 * size:g} mm" for size in sizes[0]["sizes"]]
    lines = [
        f"Error of the reference itself (`make convergence`, {found['condition']}):",
        "",
        *(
            f"- {line}"
            for line in convergence.summary(
                found["condition"],
                found["quantities"],
                found["penalty"],
                found["quadrature"],
                found["coarse_size_m"],
            )
            + convergence.told(found["ripple"])
        ),
        "",
        f"| quantity | {' | '.join(heads)} | order | ± at {heads[-1]} |",
        "|---" * (len(heads) + 3) + "|",
    ]
    for row in sizes:
        values = " | ".join("-" if value is None else f"{value:.5g}" for value in row["values"])
        lines.append(
            f"| {row['quantity']}, {row['unit']} | {values} | {_number(row['order'])} | "
            f"{_number(row['uncertainty'])} |"
        )
    return "\n".join([*lines, "", *_changes(found)])


def _changes(found: dict) -> list[str]:
    """What penalty stiffness and quadrature change."""
    lines = [
        f"| {1e3 * found['coarse_size_m']:g} mm elements | settled x, y, z, deg/s | largest change "
        f"|",
        "|---|---|---|",
    ]
    for row in found["penalty"]:
        lines.append(
            f"| {row['penalty_n_m3']:.3g} N/m³, {row['factor']:g} times the scene's | "
            f"{_changed(row)} |"
        )
    for row in found["quadrature"]:
        lines.append(
            f"| {row['points_per_edge']} x {row['points_per_edge']} Gauss points per facet | "
            f"{_changed(row)} |"
        )
    return lines


def _changed(row: dict) -> str:
    rates = ", ".join("-" if rate is None else f"{rate:.3f}" for rate in row["settled_rate_deg_s"])
    return f"{rates} | {_number(row['settled_rate_change_deg_s'])}"


def _bench(rows: list[dict]) -> str:
    first = rows[0]
    lines = [
        f"Speed of the reference solver (`make bench`, {first['threads']} threads on "
        f"{first['hardware']['processor']}), "
        f"wall ns per element and step with {first['faces_in_contact']} pad faces pressed:",
        "",
        "| elements | this solver | without contact | one thread | SciPy matrix and NumPy | ratio "
        "| bytes per element | "
        "40 ms would take |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row['elements']:,} | {row['ns_per_element_step']:.2f} | {row['ns_free']:.2f} | "
            f"{row['ns_one_thread']:.2f} | {row['baseline_ns_per_element_step']:.0f} | "
            f"{row['ratio']:.0f} | "
            f"{row['bytes_per_element']:.0f} | {row['projected_40_ms_s'] / 3600.0:.2g} h |"
        )
    return "\n".join(lines)


def _surrogate(found: dict) -> str:
    many = found["ensemble"]
    lines = [
        "Speed of the surrogate (`make bench`), processor ms per case on one core at the same "
        "error of the settled rate (95th "
        f"percentile of {found['varied_cases']} varied cases); an ensemble of {many['cases']:,} "
        f"takes "
        f"{many['cpu_ms_per_case']:.3f} ms per case at {found['single'][0]['error_percent']:g} %, "
        f"set-up included:",
        "",
        "| error | surrogate | plain Runge-Kutta | ratio | with curves |",
        "|---|---|---|---|---|",
    ]
    for row in found["single"]:
        lines.append(
            f"| {row['error_percent']:g} % | {row['cpu_ms']:.3f} | {row['baseline_cpu_ms']:.3f} | "
            f"{row['ratio']:.1f} | "
            f"{row['run_cpu_ms']:.2f} |"
        )
    return "\n".join(lines)


def _promises(highfi: dict, lowfi: dict) -> str:
    names = {
        "energy_error": "total energy",
        "transverse_energy_error": "transverse energy",
        "linear_momentum_error": "linear momentum",
        "angular_momentum_error": "angular momentum",
    }
    lines = [
        "Largest errors over all conditions, relative as defined in `tipoff/mechanics/ledger.py`:",
        "",
        "| | " + " | ".join(names.values()) + " |",
        "|---" * (len(names) + 1) + "|",
    ]
    for title, found in (("reference", highfi), ("surrogate", lowfi)):
        worst = [max(condition[name] for condition in found["conditions"]) for name in names]
        lines.append(f"| {title} | " + " | ".join(f"{value:.1e}" for value in worst) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else _ROOT / "out" / "reference")
