"""Tables of docs/results.md: balances, chaotic conditions, time at equal accuracy, error of the reference, speeds."""

from collections.abc import Sequence
from dataclasses import replace
from operator import attrgetter
from pathlib import Path

from tipoff.files import read_json
from tipoff.studies.agreement import distribution_page
from tipoff.studies.agreement import stage as compare
from tipoff.studies.agreement.distributions import Distribution
from tipoff.studies.agreement.equivalence import AXES, Comparison
from tipoff.studies.convergence import page
from tipoff.studies.convergence import stage as convergence
from tipoff.studies.convergence.stage import Convergence
from tipoff.studies.cost import stage as cost_study
from tipoff.studies.cost.results import Cost, Match
from tipoff.studies.render.document import Bullets, Part, markdown
from tipoff.studies.render.table import Cells, Column, Table, number
from tipoff.workspace.study import read
from validation.bench import reference
from validation.ripple import page as ripple_page
from validation.ripple import stage as ripple
from validation.scaling import page as scaling_page
from validation.scaling import stage as growing
from validation.scaling.results import Growth, Laws, Scaling


def details(folder: Path) -> str:
    """Markdown of all these tables; raises DamageError or OSError without the runs of both models."""
    highfi, lowfi = (read_json(folder / f"{name}.json") for name in ("highfi", "lowfi"))
    refined, slid, cost, scaling, agreement = (
        read(folder / f"{name}.json")
        for name in ("convergence", "ripple", "cost_study", "scaling", "agreement")
    )
    parts: list[Part] = [_promises(highfi, lowfi)]
    parts += (
        distributions(compare.STAGE.read(agreement).distributions) if agreement is not None else []
    )
    parts += [_cost(cost_study.STAGE.read(cost))] if cost is not None else []
    parts += [_scaling(growing.STAGE.read(scaling))] if scaling is not None else []
    slides = ripple_page.sentences(ripple.STAGE.read(slid)) if slid is not None else []
    parts += _convergence(convergence.STAGE.read(refined), slides) if refined is not None else []
    if (found := reference.stored(folder.parent)) is not None:
        parts += [_bench(found["rows"])] if found["rows"] else []
        parts += [_surrogate(found["lowfi"])] if found["lowfi"] else []
    return markdown(parts)


def distributions(found: Sequence[Distribution]) -> list[Part]:
    """Verdicts on conditions that no single run can judge; empty without such conditions."""
    if not found:
        return []
    table = distribution_page.summary(found).brief()
    title = (
        "Conditions judged as distributions (`make compare`): bound of the largest difference of a "
        "quantile, in margins. Agreement\nneeds less than 1. Springs are the control. "
        "[chaotic_conditions.md](chaotic_conditions.md) explains the test."
    )
    return [Table(table.columns, table.rows, title=title)]


def quantiles(found: Sequence[Distribution]) -> Table:
    """Quantiles of the settled rates of the finite elements and of each surrogate, condition by condition."""
    rows: list[tuple] = []
    for item in found:
        compared = next((own.comparisons for own in item.models.values() if own.comparisons), [])
        rows.append((item.condition, "finite elements", *_by_axis(compared, "reference"), "", ""))
        for own in item.models.values():
            bound = number(own.worst.bound if own.worst else None, ".2f")
            judged = own.judgement.removesuffix(" as distribution")
            rows.append(("", own.title, *_by_axis(own.comparisons, "surrogate"), bound, judged))
    heads = ("condition", "10, 50, 90 % of the rate about", *AXES, "bound", "verdict")
    return Table(heads, rows)


def _by_axis(found: Sequence[Comparison], model: str) -> list[str]:
    """The quantiles of a ``model``, reference or surrogate, in deg/s: a text for each axis; empty without
    comparisons, where launches did not settle."""
    values = [(item.axis, f"{getattr(item, f'{model}_deg_s'):z.1f}") for item in found]
    return [", ".join(value for own, value in values if own == axis) for axis in AXES]


def _cost(found: Cost) -> Table:
    columns: tuple = (
        ("model", lambda match: f"{match.model}, {match.numerics}"),
        (Column("error, deg/s", form=".2g"), attrgetter("error_deg_s")),
        (Column("wall time, ms", form=".2g", scale=1e3), attrgetter("wall_s")),
        "mesh",
        (
            Column("its error, deg/s", form=".2g"),
            lambda match: "reference" if match.mesh_is_reference else match.mesh_error_deg_s,
        ),
        ("wall time, s", attrgetter("mesh_wall_s")),
        (Column("times as long", form=",.0f"), attrgetter("ratio")),
    )
    title = (
        f"Time at equal accuracy (`make cost`, {found.condition}): each surrogate, and the coarsest "
        "mesh whose error is not larger."
    )
    return Table.of_records(found.matched, *columns, title=title, kind=Match)


def _scaling(found: Scaling) -> Table:
    """Exponents over elements and pads, and the time ratio of all effects to none."""
    over = found.elements
    laws: list[tuple[str, str, Growth | Laws]] = [
        (f"{_ends(over)} elements", over.model, over),
        ("the two finest meshes", over.model, over.finest),
        *((f"{_ends(law)} pads", law.model, law) for law in found.pads),
    ]
    rows = [
        (words, model, scaling_page.exponent(law.run), scaling_page.exponent(law.step))
        for words, model, law in laws
    ]
    prices = "; ".join(f"{item.model} {item.ratio:.2f} times" for item in found.effects)
    step = (
        ""
        if over.fixed_s is None or over.element_s is None
        else (
            f"A step of the reference takes {1e6 * over.fixed_s:.2g} µs on any mesh and "
            f"{1e9 * over.element_s:.2g} ns for each element. "
        )
    )
    return Table(
        ["over", "model", "p of a run", "p of a step"],
        rows,
        notes=(f"{step}Time with all effects over time without: {prices}.",),
        title="How time grows (`make cost`, one processor): t = c n^p. Expected over elements: 1 for "
        "a step, 4/3 for a run, because its steps\nbecome shorter too.",
    )


def _ends(law: Growth) -> str:
    return f"{law.points[0].n:,} to {law.points[-1].n:,}"


def _convergence(found: Convergence, slides: list[str]) -> list[Part]:
    sizes = found.refined("element size")
    heads = [f"{1e3 * size:g} mm" for size in sizes[0].sizes]
    rows = [
        (
            f"{row.quantity}, {row.unit}",
            *row.values,
            number(row.order, ".2g"),
            number(row.uncertainty, ".2g"),
            row.method,
        )
        for row in sizes
    ]
    columns = [Column(head, form=".5g") for head in heads]
    return [
        f"Error of the reference itself (`make convergence`, {found.condition}):",
        # The speed at equal accuracy stands beside the other speeds.
        Bullets([*page.sentences(replace(found, equal_accuracy=None)), *slides]),
        Table(["quantity", *columns, "order", f"± at {heads[-1]}", "method"], rows),
        _changes(found),
    ]


def _changes(found: Convergence) -> Table:
    """Changes by interface stiffness and by contact cells."""
    changed = [
        (f"{row.interface_stiffness_n_m3:.3g} N/m³, {row.factor:g} times the scene's", row)
        for row in found.interface_stiffness
    ] + [
        (f"{row.cells_per_edge} x {row.cells_per_edge} contact cells per pad face", row)
        for row in found.contact_cells
    ]
    return Table(
        [
            f"{1e3 * found.coarse_size_m:g} mm elements",
            Column("settled x, y, z, deg/s", form=".3f"),
            Column("largest change", form=".2g"),
        ],
        [(words, row.settled_rate_deg_s, row.settled_rate_change_deg_s) for words, row in changed],
    )


def _bench(rows: list[dict]) -> Table:
    first = rows[0]
    columns: Cells = (
        ("elements", "elements"),
        (Column("this solver", form=".2f"), "ns_per_element_step"),
        (Column("without contact", form=".2f"), "ns_free"),
        (Column("one thread", form=".2f"), "ns_one_thread"),
        (Column("SciPy matrix and NumPy", form=".0f"), "baseline_ns_per_element_step"),
        (Column("ratio", form=".0f"), "ratio"),
        (Column("bytes per element", form=".0f"), "bytes_per_element"),
        (Column("40 ms would take, h", form=".2g", scale=1.0 / 3600.0), "projected_40_ms_s"),
    )
    return Table.of(
        rows,
        columns,
        title=f"Speed of the reference solver (`make bench`, {first['threads']} threads on "
        f"{first['hardware']['processor']}), wall ns per element and step with "
        f"{first['faces_in_contact']} pad faces pressed:",
    )


def _surrogate(found: dict) -> Table:
    many = " and ".join(
        f"{row['cpu_ms_per_case']:.3f} ms on {row['method']}" for row in found["ensembles"]
    )
    columns: Cells = (
        (Column("error, %", form="g"), "error_percent"),
        ("method", "method"),
        (Column("time", form=".3f"), "cpu_ms"),
        (Column("with curves", form=".2f"), "run_cpu_ms"),
        (Column("with curves and modes chosen", form=".2f"), "run_auto_cpu_ms"),
    )
    return Table.of(
        found["single"],
        columns,
        title="Speed of the surrogate (`make bench`): processor ms per case on one core, at the "
        f"same error of the settled rate (95th percentile of {found['varied_cases']} "
        f"varied cases). An ensemble of {found['ensembles'][0]['cases']:,} takes {many} "
        f"per case at {found['single'][0]['error_percent']:g} %, set-up and the choice of "
        f"modes included. Modes of compliant contact: {found['modes_why']}; in the last "
        "column each run chooses its own:",
    )


def _promises(highfi: dict, lowfi: dict) -> Table:
    names = {
        "energy_error": "total energy",
        "transverse_energy_error": "transverse energy",
        "linear_momentum_error": "linear momentum",
        "angular_momentum_error": "angular momentum",
    }
    rows = [
        (title, *(max(condition[name] for condition in found["conditions"]) for name in names))
        for title, found in (("reference", highfi), ("surrogate", lowfi))
    ]
    return Table(
        ["", *(Column(title, form=".1e") for title in names.values())],
        rows,
        title="Largest errors over all conditions, relative as defined in "
        "`tipoff/mechanics/ledger.py`:",
    )
