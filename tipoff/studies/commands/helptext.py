"""Help text for a terminal: prose is wrapped to its width, examples keep their lines."""

import inspect

import typer


def flow(app: typer.Typer) -> None:
    """Reflow the help, or the docstring, of every command of ``app``."""
    for command in app.registered_commands:
        command.help = flowed(command.help or inspect.getdoc(command.callback) or "")


def flowed(text: str) -> str:
    """``text`` with each paragraph on one line; indented paragraphs are unchanged."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(
        item if item.startswith(" ") else " ".join(item.split()) for item in paragraphs
    )
