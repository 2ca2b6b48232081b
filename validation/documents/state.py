"""From which state of tipoff the results of a page are: version, commit, day and machine."""

from collections.abc import Mapping

from tipoff.workspace import machine


def sentence(documents: Mapping[str, dict | None]) -> str:
    """Markdown with the state of each result file, by name; a file that does not exist is None. Files of
    one state share a line."""
    by_state: dict[str, list[str]] = {}
    for name, document in documents.items():
        if document is not None:
            by_state.setdefault(machine.stated(document.get("state")), []).append(f"`{name}.json`")
    if len(by_state) == 1:
        return f"State: {next(iter(by_state))}."
    lines = [f"- {', '.join(names)}: {said}" for said, names in by_state.items()]
    return "\n".join(["The results are from several states:", "", *lines])


def mark(name: str, document: dict) -> str:
    """The first line of the part ``name`` of a page: the state of its numbers, and what writes it."""
    said = machine.stated(document.get("state"))
    return f"<!-- {name}, state {said}: python -m validation.documents.readme -->"
