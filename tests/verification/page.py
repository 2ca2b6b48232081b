"""docs/verification_and_validation.md: the cases with what their tests compared, the measurements,
other codes, and what was held against none of them.

It is made from tests/CASES.md, the sources of the tests, tests/verification/recorded.json and
tests/measurements/published.toml.
"""

import json
import re
import tomllib
from collections import defaultdict
from typing import Any

from tests.verification import limits, reading

RECORDED = reading.ROOT / "tests" / "verification" / "recorded.json"
PAGE = reading.ROOT / "docs" / "verification_and_validation.md"
CASES = reading.ROOT / "tests" / "CASES.md"
MEASURED = reading.ROOT / "tests" / "measurements" / "published.toml"
PEERS = reading.ROOT / "docs" / "peers.md"
_MOST = 2  # controls of a case that are quoted


def recorded() -> dict[str, dict[str, Any]]:
    """What the tests compared when `python -m tests.verification` last ran them, by file and
    name."""
    return json.loads(RECORDED.read_text()) if RECORDED.exists() else {}


def text() -> str:
    """The page."""
    kept = recorded()
    parts = [
        limits.HEAD.format(**_counts(kept)),
        *(_section(title, rows, kept) for title, rows in sections(CASES.read_text())),
        _measurements(tomllib.loads(MEASURED.read_text())),
        _peers(),
        limits.TAIL,
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def sections(cases: str) -> list[tuple[str, list[list[str]]]]:
    """Headings of tests/CASES.md with the rows below each: id, what, answer, source."""
    found: list[tuple[str, list[list[str]]]] = []
    for line in cases.splitlines():
        if line.startswith("## "):
            found.append((line.removeprefix("## "), []))
        elif re.match(r"\| [OX]\d+ \|", line):
            found[-1][1].append([cell.strip() for cell in line.strip("| ").split(" | ")])
    return found


def _counts(kept: dict) -> dict[str, int]:
    ids = [row[0] for _, rows in sections(CASES.read_text()) for row in rows]
    controlled = {case for test in reading.all_tests() if test.controls for case in test.cases}
    return {
        "cases": len(ids),
        "tests": len(kept),
        "comparisons": sum(entry["comparisons"] for entry in kept.values()),
        "controlled": len(controlled & set(ids)),
    }


def _section(title: str, rows: list[list[str]], kept: dict) -> str:
    entries = defaultdict(list)
    for entry in kept.values():
        for case in entry["cases"]:
            entries[case].append(entry)
    controls = defaultdict(list)
    for test in reading.all_tests():
        for case in test.cases:
            controls[case] += [said for said in test.controls if said not in controls[case]]
    lines = [_row(case, entries[case[0]], controls[case[0]]) for case in rows]
    columns = (
        "id", "case", "answer, source", "ours", "answer", "error / tolerance", "comparisons", "order",
        "control that fails",
    )  # fmt: skip
    return f"## {title}\n\n" + table(columns, lines)


def _row(case: list[str], entries: list[dict], controls: list[str]) -> list[str]:
    name, what, answer, source = case
    worst = [entry["worst"] for entry in entries if entry["worst"]]
    closest = max(worst, key=lambda found: found["ratio"], default=None)
    orders = [order for entry in entries for order in entry["orders"]]
    seen = [said for entry in entries for said in entry["controls"]]
    quoted = " ".join(controls[:_MOST]) or "none is named"
    more = f" {len(controls) - _MOST} more." if len(controls) > _MOST else ""
    values = f" ({'; '.join(seen[:_MOST])})" if seen and controls else ""
    return [
        name,
        what,
        f"{answer}; {source}" if source != "-" else answer,
        *(nearest(closest) if entries else ("–", "–", "–")),
        str(sum(entry["comparisons"] for entry in entries)) if entries else "not recorded",
        ", ".join(f"{order:.2f}" for order in orders[:4]) or "–",
        quoted + values + more,
    ]


def nearest(found: dict | None) -> tuple[str, str, str]:
    """Ours, the answer and the share of the tolerance; an error stands by itself."""
    if found is None:
        return "yes or no", "–", "–"
    if found["answer"] == 0.0:
        return f"error {found['ours']:.1e}", f"≤ {found['allowed']:.1e}", _share(found["ratio"])
    digits = 8 if found["allowed"] < 1e-5 * abs(found["answer"]) else 6
    return (
        f"{found['ours']:.{digits}g}",
        f"{found['answer']:.{digits}g} ± {found['allowed']:.1e}",
        _share(found["ratio"]),
    )


def _share(ratio: float) -> str:
    return f"{ratio:.2f}" if ratio >= 0.01 or ratio == 0.0 else f"{ratio:.0e}"


def _measurements(found: dict) -> str:
    parts = [limits.MEASURED]
    parts += [_measurement(item) for item in found["measurement"]]
    parts.append("### Inputs")
    parts += [_input(item) for item in found["input"]]
    parts.append("### Looked for and not found\n\n" + table(
        ("what", "what there is"), [[item["what"], item["found"]] for item in found["missing"]]
    ))  # fmt: skip
    return "\n\n".join(parts)


def _measurement(item: dict) -> str:
    facts = [
        f"- {name}: {item[key].rstrip('.')}."
        for name, key in (
            ("Tests", "tests"), ("Source", "source"), ("Read", "read"), ("Conditions", "conditions"),
            ("Uncertainty", "uncertainty"), ("Not known", "unknown"),
        )
    ]  # fmt: skip
    tables = "\n\n".join(_series(series) for series in item["series"])
    return f"### {item['id']} {item['title']}\n\n" + "\n".join(facts) + f"\n\n{tables}"


def _series(series: dict) -> str:
    unit = f", {series['unit']}" if series["unit"] else ""
    rows = [
        [f"{at:g}", f"{measured:g}", f"{ours:g}", _percent(100.0 * (ours / measured - 1.0))]
        for at, measured, ours in zip(series["at"], series["measured"], series["ours"])
    ]
    off = [100.0 * abs(ours / kept - 1.0) for kept, ours in zip(series["measured"], series["ours"])]
    shown = rows[: series.get("shown", len(rows))]
    mean = (sum(value**2 for value in off) / len(off)) ** 0.5
    spread = f"largest {max(off):.2g} %, root mean square {mean:.2g} %"
    all_of = f"All {len(rows)}: {spread}. " if len(shown) < len(rows) else ""
    verdict = "Within" if series["agrees"] else "**Not** within"
    columns = (series["over"], f"measured{unit}", f"ours{unit}", "difference, %")
    return (
        f"{series['quantity'][0].upper()}{series['quantity'][1:]}:\n\n{table(columns, shown)}\n\n"
        f"{all_of}{verdict} {series['within']}."
    )


def _percent(value: float) -> str:
    return f"{value:+.0f}" if abs(value) >= 10.0 else f"{value:+.2g}"


def _input(item: dict) -> str:
    parts = [
        f"{item['id']} {item['title']}. Scene: {item['scene']}. Found: {item['found']} "
        f"{item['judgement']}"
    ]
    for series in item["series"]:
        values = [f"{ours:.2g} at {at:g}" for at, ours in zip(series["at"], series["ours"])]
        parts.append(
            f"{series['quantity'].capitalize()} of the reference scene, phi35, {series['unit']}, "
            f"by {series['over']}: {', '.join(values)}."
        )
    return "\n\n".join(parts)


def _peers() -> str:
    """The first table of docs/peers.md, where other codes computed the same cases."""
    if not PEERS.exists():
        return "## Other codes\n\nNo comparison with another code is kept."
    first = re.search(r"(?:^\|.*\n)+", PEERS.read_text(), re.MULTILINE)
    found = first[0].strip() if first else ""
    return f"## Other codes\n\n[peers.md](peers.md) has the comparison.\n\n{found}"


def table(columns: tuple[str, ...], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines)


def _cell(words: str) -> str:
    return words.replace("|", "\\|")
