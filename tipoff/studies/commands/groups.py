"""Groups of commands in the help of ``tipoff``."""

import typer


def group(app: typer.Typer, title: str) -> None:
    """List the commands of ``app`` that are in no group yet under ``title``."""
    for command in app.registered_commands:
        if not isinstance(command.rich_help_panel, str):
            command.rich_help_panel = title
