"""Every command with its options, from the command line itself."""

from enum import Enum
from typing import Any

import typer.main

from docs.pages.markdown import table
from tipoff.studies.cli import app


def commands() -> dict[str, Any]:
    """Every command by name, as typer has it for its parser."""
    group: Any = typer.main.get_command(app)
    return dict(group.commands)


def markdown() -> str:
    """One section for each command."""
    return "\n\n".join(_section(name, command) for name, command in commands().items())


def _section(name: str, command: Any) -> str:
    parts = [f"## tipoff {name}", *_paragraphs(command.help or "")]
    arguments = [item for item in command.params if item.param_type_name == "argument"]
    parts += [f"`{item.name.upper()}`: {_plain(item.help)}" for item in arguments]
    options = [item for item in command.params if item.param_type_name == "option"]
    rows = [(_names(item), _default(item), _plain(item.help)) for item in options]
    return "\n\n".join([*parts, table(("option", "default", "meaning"), rows)])


def _plain(text: str | None) -> str:
    """Text without the marks of rich; what looks like a tag is shown as it is."""
    return (text or "").replace("\\[", "[").replace("<", "\\<").replace("*", "\\*")


def _paragraphs(text: str) -> list[str]:
    """Prose as it is, indented paragraphs as blocks of code."""
    found = []
    for part in text.split("\n\n"):
        if part.startswith(" "):
            lines = "\n".join(line.strip() for line in part.splitlines()).replace("\\[", "[")
            found.append(f"```text\n{lines}\n```")
        else:
            found.append(_plain(part))
    return found


def _names(option: Any) -> str:
    value = "" if option.is_flag else f" {option.metavar or _kind(option)}"
    return f"`{', '.join([*option.opts, *option.secondary_opts])}{value}`"


def _kind(option: Any) -> str:
    """The choices of an option, or the name of its type."""
    kind = option.type_descriptor.annotation
    if isinstance(kind, type) and issubclass(kind, Enum):
        return "|".join(each.value for each in kind)
    return getattr(kind, "__name__", "value").upper()


def _default(option: Any) -> str:
    default = option.default
    if default is None or default == () or default == []:
        return ""
    if option.is_flag:
        return "on" if default else "off"
    return f"`{getattr(default, 'value', default)}`"
