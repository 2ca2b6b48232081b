"""Commands with options of their own, one file each: ``add(app)`` puts it under ``tipoff``."""

from importlib import import_module

import typer

NAMES = ("blind", "sensitivity", "sweeps", "montecarlo", "limits", "flight", "droptest", "paper")


def add_all(app: typer.Typer) -> None:
    """Put every command under ``app``, in the order of the pipeline."""
    for name in NAMES:
        import_module(f"{__name__}.{name}").add(app)
