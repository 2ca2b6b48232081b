"""How tests of the evidence treat figures: as those of studies do."""

from collections.abc import Callable

import pytest
import typer
from typer.testing import CliRunner

from tests.studies.conftest import figures

__all__ = ["figures"]


@pytest.fixture
def call() -> Callable:
    """Call a command with arguments, in this process."""

    def called(command: Callable[..., None], arguments: list[str]):
        app = typer.Typer()
        app.command()(command)
        return CliRunner().invoke(app, arguments)

    return called
