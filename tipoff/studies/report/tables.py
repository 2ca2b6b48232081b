"""Tables of the result files: calibration, agreement, cost, stability, ablation, speed-up."""

from html import escape

from tipoff.studies import published
from tipoff.studies.convergence import equal_accuracy
from tipoff.studies.render.markup import (
    Html,
    caption,
    code,
    fold,
    number,
    paragraph,
    percent,
    section,
    table,
)

_INTERVALS = (
    "Intervals are linear and take what the fit leaves for scatter about a model that is right. "
    "Model error is not in "
    "them: what the surrogate lacks may move its constants by more than they say. "
    "Not told: the curves do not fix the constant, and no interval is made up."
)
_HEADS = (
    "condition",
    "role",
    "rate L2 (%)",
    "floor L2 (%)",
    Html("v<sub>x</sub> L2 (%)"),
    "settled error (deg/s)",
    "error x, y, z (deg/s)",
    "floor (deg/s)",
    "reference ± (deg/s)",
    "ISO 18571",
    "S-G magnitude (%)",
    "S-G phase (%)",
    "verdict",
)
_FLOOR = "Floor: what ±{change:g} µm of clearance changes in either model. "


def agreement(document: dict) -> Html:
    """The agreement tables, the surrogate on compliant contact first, with floor and reference
    uncertainty beside every claim."""
    gates = document["gates"]
    legend = (
        f"Gates: rate L2 {percent(gates['rate_relative_l2'])} %, v_x L2 "
        f"{percent(gates['velocity_relative_l2'])} %, "
        f"settled error {gates['settled_rate_error_deg_s']:g} deg/s, or twice the floor where that "
        f"is more. "
        + _FLOOR.format(change=1e6 * document["clearance_change_m"])
        + "Reference ±: the largest change of its settled rates from twice the element size on, "
        f"and there under half the step or four times the penalty; above "
        f"{document['converged_deg_s']:g} deg/s no agreement "
        "is claimed. A star marks a value measured on other conditions, of which the largest is "
        "taken. ISO 18571 is the mean "
        "rating of the three rates (1 is perfect); Sprague and Geers over the three rates together."
    )
    calibrated = [*document["fitted"], *document["held_out"]]
    return section(
        "agreement-section",
        "Agreement with the reference",
        paragraph(
            "On compliant contact as the statics of the rail has them, nothing fitted (the role is "
            "that of the "
            "condition in the calibration of springs): " + summary(document["compliant"])
        ),
        judged(document["compliant"], "agreement"),
        caption(legend),
        _further(document["compliant"]),
        _simpler(document),
        _stiffer(document["stiffer"]),
        paragraph(
            "One spring and damper per pad face, calibrated on the fitted conditions: "
            + summary(document["fitted"], "fitted ")
            + "; "
            + summary(document["held_out"], "held-out ")
        ),
        judged(calibrated, "agreement-calibrated"),
        _further(calibrated),
        fold(
            "the same before calibration",
            judged(document["uncalibrated"], "agreement-uncalibrated"),
        ),
        _evidence(document),
    )


def judged(rows: list[dict], name: str) -> Html:
    """A table of agreement rows: good, bad, or of a reference that is not converged."""
    kinds = [
        "doubt" if not row["reference_converged"] else "good" if row["passes"] else "bad"
        for row in rows
    ]
    return table(_HEADS, [_agreement_row(row) for row in rows], name, kinds, dense=True)


def _simpler(document: dict) -> Html:
    """What each part of the walls' flexibility is worth."""
    found = document["simpler"]
    names = list(dict.fromkeys(item["condition"] for item in found))
    rows = []
    for words in dict.fromkeys(item["walls"] for item in found):
        own = {item["condition"]: item for item in found if item["walls"] == words}
        rows.append((words, *(_errors(own[name]) for name in names)))
    whole = {
        "all": "compliant",
        f"all, and the {document['rail_modes']} lowest modes of each rail": "modal",
    }
    rows += [
        (
            words,
            *(
                _errors(row)
                for name in names
                for row in document[group]
                if row["condition"] == name
            ),
        )
        for words, group in whole.items()
    ]
    return fold(
        "what the parts of the flexibility are worth: rate L2 (%) and settled error (deg/s) when "
        "the surrogate knows less, "
        "or more",
        table(("walls", *names), rows, dense=True),
    )


def _stiffer(found: list[dict]) -> Html:
    """What the penalty makes uncertain, and what of it is a difference of the models."""
    if not found:
        return Html("")
    rows = [
        (
            item["condition"],
            *(
                number(item[key], 2)
                for key in (
                    "reference_change_deg_s",
                    "surrogate_change_deg_s",
                    "apart_deg_s",
                    "apart_with_more_deg_s",
                )
            ),
        )
        for item in found
    ]
    return fold(
        "four times the penalty in both models: how far settled rates move, and how far apart the "
        "models are (deg/s)",
        table(
            (
                "condition",
                "the reference moves by",
                "the surrogate moves by",
                "apart before",
                "apart after",
            ),
            rows,
        ),
        caption(
            "The reference on the coarse mesh. Where both move alike the stiffness of the penalty "
            "makes the answer "
            "uncertain, and the agreement of the models does not depend on it."
        ),
    )


def _errors(row: dict) -> str:
    return f"{percent(row['rate_relative_l2'])}; {number(row['settled_rate_error_deg_s'], 2)}"


def summary(rows: list[dict], words: str = "") -> str:
    """How many of the ``words`` conditions agree."""
    passed, doubtful = (
        sum(row["passes"] for row in rows),
        sum(not row["reference_converged"] for row in rows),
    )
    return (
        f"{passed} of {len(rows)} {words}conditions pass all three gates"
        + _free(rows)
        + (
            f" ({doubtful} of {len(rows)} with a reference that is not converged)"
            if doubtful
            else ""
        )
    )


def _free(rows: list[dict]) -> str:
    count = sum(row["passes"] and not row["touches"] for row in rows)
    return f", {count} of them without touching the rail at all" if count else ""


def _agreement_row(row: dict) -> tuple:
    floor_here, uncertainty_here = (
        row["floor_measured_here"],
        row["reference_uncertainty_measured_here"],
    )
    xyz = row["settled_rate_error_xyz_deg_s"]
    return (
        row["condition"],
        row["role"].replace("_", " "),
        percent(row["rate_relative_l2"]),
        _starred(percent(row["floor_l2"]), floor_here),
        percent(row["velocity_relative_l2"]),
        number(row["settled_rate_error_deg_s"]),
        "–" if xyz is None else ", ".join(f"{value:+.2g}" for value in xyz),
        _starred(number(row["floor_deg_s"]), floor_here),
        _starred(number(row["reference_uncertainty_deg_s"]), uncertainty_here),
        f"{row['iso18571']:.3f}",
        percent(row["sprague_geers_magnitude"]),
        percent(row["sprague_geers_phase"]),
        row["verdict"],
    )


def _starred(shown: str, measured_here: bool) -> Html:
    """A number, with a star where it was measured on other conditions."""
    return Html(shown if measured_here else f"{shown}*")


def _further(rows: list[dict]) -> Html:
    """Lateral velocity, direction, and the ratings of each channel."""
    channels = list(rows[0]["iso18571_channels"]) if rows else []
    lines = [
        (
            row["condition"],
            *(
                _signed(row[name], factor)
                for name, factor in (
                    ("lateral_velocity_difference_m_s", 1e3),
                    ("direction_error_difference_deg", 1.0),
                )
            ),
            *(f"{row['iso18571_channels'][name]:.3f}" for name in channels),
            *(_pair(row["sprague_geers_channels"][name]) for name in channels),
        )
        for row in rows
    ]
    names = [name.replace("_", " ") for name in channels]
    return fold(
        "lateral velocity, direction, and each channel by itself",
        table(
            (
                "condition",
                "lateral velocity (mm/s)",
                "direction (deg)",
                *(f"ISO 18571, {name}" for name in names),
                *(f"S-G M; P (%), {name}" for name in names),
            ),
            lines,
            dense=True,
        ),
        caption("Differences are surrogate minus reference."),
    )


def _signed(value: float | None, factor: float) -> str:
    return "–" if value is None else f"{factor * value:+.3g}"


def _pair(values: list[float] | None) -> str:
    return "–" if values is None else "; ".join(f"{100.0 * value:.2g}" for value in values)


def _evidence(document: dict) -> Html:
    rows = [
        (
            item["condition"],
            item["model"],
            item["cause"],
            percent(item["rate_relative_l2"]),
            number(item["settled_rate_change_deg_s"]),
        )
        for item in [*document["floor"], *document["refinement"]]
    ]
    return fold(
        "floor and reference uncertainty as measured",
        table(
            ("condition", "model", "what was changed", "rate L2 (%)", "settled rates (deg/s)"), rows
        ),
    )


def calibration(document: dict) -> Html:
    """Fitted constants with bounds and reasons, what the curves cannot tell, residuals."""
    rows = [
        (name, number(value, 5), _interval(ends), unit, number(low, 4), number(high, 4), why)
        for name, value, ends, unit, low, high, why in zip(
            *(
                document[key]
                for key in (
                    "parameters",
                    "values",
                    "intervals",
                    "units",
                    "lower",
                    "upper",
                    "justification",
                )
            )
        )
    ]
    weak = (
        "".join(f"<li>{escape(line)}</li>" for line in document["weak_directions"])
        or "<li>none</li>"
    )
    names = list(dict.fromkeys(key for found in document["residuals"].values() for key in found))
    residuals = [
        (condition, *(found.get(name) for name in names))
        for condition, found in document["residuals"].items()
    ]
    information = [
        (name, *line) for name, line in zip(document["parameters"], document["information"])
    ]
    applied = [(code(key), number(value, 6)) for key, value in document["constants"].items()]
    return section(
        "calibration",
        "Calibration",
        paragraph(
            f"Fitted to {', '.join(document['conditions'])} at once; objective "
            f"{document['objective']:.4g}."
        ),
        table(
            (
                "constant",
                "value",
                "95 % interval",
                "unit",
                "lower bound",
                "upper bound",
                "why free, why these bounds",
            ),
            rows,
        ),
        caption(_INTERVALS),
        Html(f"<h3>What the curves cannot tell</h3><ul>{weak}</ul>"),
        fold("constants the surrogate then uses (SI)", table(("key", "value"), applied)),
        fold("how they were found", table(("", ""), document["provenance"].items())),
        fold(
            "residuals per condition",
            table(("condition", *(name.replace("_", " ") for name in names)), residuals),
        ),
        fold(
            "information matrix of the scaled constants",
            table(("", *document["parameters"]), information),
        ),
    )


def _interval(ends: list[float | None]) -> Html | str:
    return "not told" if None in ends else Html(f"{number(ends[0], 4)} to {number(ends[1], 4)}")


def speedups(document: dict, equal: dict | None = None) -> Html:
    """Wall times of the reference and of two surrogates on one machine, their ratios and the
    scatter; and those at ``equal`` accuracy, where the error of the reference was studied."""
    found = document["speedup_compliant"]
    machine = found["hardware"]
    return section(
        "speedup",
        "Speed",
        paragraph("Model compliant:"),
        _speedup(found),
        paragraph("Model springs, calibrated:"),
        _speedup(document["speedup"]),
        caption(
            f"Condition {found['condition']}, all models by turns in one go, all included but "
            f"compilation, on {machine['processor']}, "
            f"{machine['cores']} cores, {machine['memory_gib']} GiB, Python {machine['python']}."
        ),
        _equal(equal),
    )


def _equal(found: dict | None) -> Html:
    """The mesh above is fixed; the one that a speed-up should be measured on is as sure as the
    surrogate is exact."""
    if found is None:
        return paragraph(
            "How much faster at equal accuracy: make convergence tells, on the mesh that is as "
            "sure as the surrogate "
            "is exact."
        )
    said = equal_accuracy.sentence(found)
    asked = float(published.headline()["speedup"])
    return paragraph(f"{said[0].upper()}{said[1:]}. The paper has {asked:,.0f} for its two models.")


def _speedup(found: dict) -> Html:
    rows = [
        (
            "wall time of one reference run",
            f"{found['highfi_wall_s']:.4g} s",
            f"{found['highfi_repeats']} repeats, "
            f"{_range(found['highfi_wall_range_s'])} s, {found['elements']:,} elements",
        ),
        (
            "wall time of one surrogate run",
            f"{1e3 * found['lowfi_wall_s']:.4g} ms",
            f"{found['lowfi_repeats']} repeats, "
            f"{_range([1e3 * value for value in found['lowfi_wall_range_s']])} ms, warm",
        ),
        (
            "ratio of wall times",
            f"{found['ratio']:,.0f}",
            f"{found['low']:,.0f} to {found['high']:,.0f} over all pairs of repeats",
        ),
        (
            "ratio of kernels alone",
            _whole(found["kernel_ratio"]),
            "time loops only, without set-up and output",
        ),
        ("ratio of processor times", _whole(found["cpu_ratio"]), "of the whole process"),
    ]
    return table(("", "value", "how measured"), rows)


def _range(values: list[float]) -> str:
    return f"{min(values):.3g} to {max(values):.3g}"


def _whole(value: float | None) -> str:
    return "–" if value is None else f"{value:,.0f}"


def cost(document: dict) -> Html:
    """Error against wall time, as numbers."""
    rows = [
        (
            p["model"],
            p["numerics"],
            f"{p['wall_s']:.3g}",
            "the yardstick" if p["error_deg_s"] is None else number(p["error_deg_s"]),
            "the yardstick" if p["curve_error"] is None else number(100.0 * p["curve_error"]),
            number(p["integration_error_deg_s"]),
            "best at its price" if p["pareto"] else "",
        )
        for p in document["points"]
    ]
    same = [
        (
            m["model"],
            f"{m['numerics']}, {1e3 * m['wall_s']:.3g} ms",
            number(m["error_deg_s"]),
            f"{m['mesh']}, {m['mesh_wall_s']:.3g} s",
            "the yardstick" if m["mesh_error_deg_s"] is None else number(m["mesh_error_deg_s"]),
            f"{m['ratio']:,.0f}",
        )
        for m in document["matched"]
    ]
    return Html(
        table(
            (
                "model",
                "numerics",
                "wall time (s)",
                "error (deg/s)",
                "rate L2 (%)",
                "of which time integration (deg/s)",
                "",
            ),
            rows,
        )
        + paragraph(
            "What the same accuracy costs with finite elements: "
            "the coarsest mesh that is no less exact than each surrogate."
        )
        + table(
            (
                "surrogate",
                "as fast as it is so exact",
                "error (deg/s)",
                "mesh",
                "error (deg/s)",
                "times as long",
            ),
            same,
        )
    )


def stability(document: dict) -> Html:
    """Hard cases, held or not, each beside a method that fails."""
    heads = (
        "case",
        "model",
        "measured",
        "limit",
        "largest step (µs)",
        "critical step (µs)",
        "energy drift",
        "simpler method",
        "its figure",
        "verdict",
    )
    rows = [
        (
            _case(c),
            c["fidelity"],
            _figure(c["figure"]),
            number(c["limit"]),
            _micro(c["largest_step_s"]),
            _micro(c["critical_step_s"]),
            number(c["energy_drift"], 2),
            c["control"],
            _figure(c["control_figure"]),
            _held(c),
        )
        for c in document["cases"]
    ]
    kinds = ["good" if c["held"] and c["control_failed"] else "bad" for c in document["cases"]]
    return section(
        "stability",
        "Hard cases",
        paragraph("Each case stands beside a simpler method that must fail on it."),
        table(heads, rows, kinds=kinds, dense=True),
        caption(
            "Largest step: of the surrogate the proven limit at its smallest, which no step "
            "passed; of the reference the step it took. "
            "Critical step: 2 / ω of the case made linear at its stiffest, beyond which central "
            "differences grow, "
            "or 2 / rate where friction damps faster. Energy drift: largest residual of the total "
            "energy ledger over its scale. A "
            "dash: nothing touches or vibrates, or no figure applies."
        ),
    )


def _case(case: dict) -> Html:
    """Name, what is measured and a remark in one cell, so that the table keeps to the page."""
    remark = f"; {case['note']}" if case["note"] else ""
    return Html(
        f'{escape(case["name"])}<br><span class="small">{escape(case["measure"] + remark)}</span>'
    )


def _micro(seconds: float | None) -> str:
    return "–" if seconds is None else number(1e6 * seconds)


def _figure(value: float | None) -> str:
    return "infinite" if value is None else number(value)


def _held(case: dict) -> str:
    if not case["held"]:
        return "not held"
    return (
        "held; the simpler one fails"
        if case["control_failed"]
        else "held, but the simpler one holds too"
    )


def bench(rows: list[dict], surrogate: dict | None) -> Html:
    """Speed of the reference solver by mesh, and of the surrogate by error."""
    return section(
        "bench",
        "Speed of the solvers",
        _solver(rows) if rows else Html(""),
        _surrogate(surrogate) if surrogate else Html(""),
    )


def _solver(rows: list[dict]) -> Html:
    heads = (
        "elements",
        "pads pressed (ns)",
        "free (ns)",
        "one thread (ns)",
        "SciPy and NumPy (ns)",
        "ratio",
        "bytes per element",
        "set-up (s)",
        "40 ms would take (h)",
    )
    lines = [
        (
            f"{row['elements']:,}",
            f"{row['ns_per_element_step']:.2f}",
            f"{row['ns_free']:.2f}",
            f"{row['ns_one_thread']:.2f}",
            f"{row['baseline_ns_per_element_step']:.0f}",
            f"{row['ratio']:.1f}",
            f"{row['bytes_per_element']:.0f}",
            f"{row['set_up_s']:.1f}",
            f"{row['projected_40_ms_s'] / 3600.0:.2g}",
        )
        for row in rows
    ]
    first = rows[0]
    return Html(
        table(heads, lines)
        + caption(
            f"Reference: wall time per element and step on {first['threads']} threads, "
            f"{first['faces_in_contact']} pad faces pressed "
            f"or none; medians of {first['repeats']} repeats by turns, compilation apart. Beside "
            f"it central differences with an "
            f"assembled SciPy matrix and NumPy, without contact. {first['hardware']['cores']} "
            f"cores of "
            f"{first['hardware']['processor']}."
        )
    )


def _surrogate(found: dict) -> Html:
    heads = (
        "error of the settled rate (%)",
        "surrogate (ms)",
        "plain Runge-Kutta (ms)",
        "ratio",
        "with curves (ms)",
        "tolerance",
        "step of the plain one (us)",
    )
    lines = [
        (
            f"{row['error_percent']:g}",
            f"{row['cpu_ms']:.3f}",
            f"{row['baseline_cpu_ms']:.3f}",
            f"{row['ratio']:.1f}",
            f"{row['run_cpu_ms']:.2f}",
            f"{row['tolerance']:g}",
            f"{1e6 * row['baseline_dt_s']:.3g}",
        )
        for row in found["single"]
    ]
    many = found["ensemble"]
    return Html(
        table(heads, lines)
        + caption(
            f"Surrogate: processor time of one core per case, the coarsest setting whose 95th "
            f"percentile over {found['varied_cases']} "
            f"varied cases keeps to the error; set-up apart. An ensemble of {many['cases']:,} "
            f"cases at the first error, set-up "
            f"included: {many['cpu_ms_per_case']:.3f} ms of processor time per case, "
            f"{many['wall_s']:.2g} s in all. "
            f"{found['hardware']['processor']}."
        )
    )


def ablation(document: dict) -> Html:
    """Every effect off, both fidelities: what it costs and what it changes."""
    heads = (
        "model",
        "variant",
        "status",
        "time (s)",
        "time ratio",
        "ns per step",
        "settled x, y, z (deg/s)",
        "change x, y, z (deg/s)",
        "effects in the compiled kernel",
    )
    rows = [
        (
            row["fidelity"],
            row["variant"],
            row["status"],
            f"{row['time_s']:.3g}",
            f"{row['time_ratio']:.2f}",
            f"{row['ns_per_step']:,.0f}",
            _three(row["settled_rate_deg_s"], ""),
            _three(row["settled_rate_change_deg_s"], "+"),
            ", ".join(row["compiled"]) or "none",
        )
        for row in document["rows"]
    ]
    return section(
        "ablation",
        "Only what the scene calls for",
        table(heads, rows),
        caption(
            f"Condition {document['condition']}; reference on {1e3 * document['element_size_m']:g} "
            f"mm elements, surrogate on compliant "
            "contact. Times, without compilation: of a whole run of the reference, of the time "
            "loop of the surrogate. The first "
            "line of each model has every effect on, those the scene lacks with small values; each "
            "further line takes one away."
        ),
    )


def _three(values: list[float] | None, sign: str) -> str:
    return (
        "–"
        if values is None
        else ", ".join(f"{value:{sign}.3g}" if value else "0" for value in values)
    )
