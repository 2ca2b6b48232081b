"""Help text for a terminal: prose is wrapped to its width, examples keep their lines."""

import inspect


def flowed(text: str) -> str:
    """``text`` with each paragraph on one line; indented paragraphs are unchanged."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(
        item if item.startswith(" ") else " ".join(item.split()) for item in paragraphs
    )
