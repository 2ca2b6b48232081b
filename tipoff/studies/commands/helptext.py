"""Help as a terminal shows it: prose flows to the width there is, examples keep their lines."""

import inspect

import typer


def flow(app: typer.Typer) -> None:
    """Give every command of ``app`` its help, or its docstring, with the paragraphs that are not
    indented on one line each."""
    for command in app.registered_commands:
        command.help = flowed(command.help or inspect.getdoc(command.callback) or "")


def flowed(text: str) -> str:
    """``text`` with the line breaks of its prose taken out; indented paragraphs are left as they
    are."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(
        item if item.startswith(" ") else " ".join(item.split()) for item in paragraphs
    )
