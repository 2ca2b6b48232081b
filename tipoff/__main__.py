"""``python -m tipoff`` and the command ``tipoff``."""

import sys


def main() -> None:
    """Run the command line. Ctrl-C ends it with exit code 130 and a file that the machine refuses
    with 1, also while modules load."""
    try:
        from tipoff.studies.cli import app

        app()
    except KeyboardInterrupt:
        print("tipoff: stopped", file=sys.stderr)
        sys.exit(130)
    except OSError as error:
        print(f"tipoff: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
