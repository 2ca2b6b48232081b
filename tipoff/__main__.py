"""``python -m tipoff`` and the command ``tipoff``."""

import os
import sys


def main() -> None:
    """Run the command line. Ctrl-C ends it with exit code 130 and a file that the machine refuses
    with 1, also while modules load."""
    _one_thread_of_blas()
    try:
        from tipoff.studies.cli import app

        app()
    except KeyboardInterrupt:
        print("tipoff: stopped", file=sys.stderr)
        sys.exit(130)
    except OSError as error:
        print(f"tipoff: {error}", file=sys.stderr)
        sys.exit(1)


def _one_thread_of_blas() -> None:
    """Before NumPy loads. The matrices of this program are small: more threads of BLAS wait for
    each other, and take the cores of the kernels and of runs side by side."""
    for library in ("OPENBLAS", "MKL", "BLIS"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")


if __name__ == "__main__":
    main()
