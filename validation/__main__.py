"""``python -m validation``: the commands of ``tipoff`` and those of the evidence."""

from tipoff import __main__ as program
from tipoff.studies import cli, registry
from validation import STUDIES


def main() -> None:
    """Run the command line."""
    registry.add(*STUDIES, program="python -m validation")
    cli.add("Evidence about tipoff", STUDIES)
    program.main()


if __name__ == "__main__":
    main()
