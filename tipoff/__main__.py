"""``python -m tipoff`` and the command ``tipoff``."""

import atexit
import gc
import os
import signal
import sys
import threading

# New objects before a collection of garbage, and collections of each older generation. The modules of
# a command make 100,000 objects that stay: to look through them takes a tenth of a short command.
_RARE = 20_000, 50, 50


def main() -> None:
    """Run the command line. The exit code is 130 after Ctrl-C, and 1 if the machine refuses a file,
    even while modules load."""
    _one_thread_of_blas()
    gc.set_threshold(*_RARE)
    atexit.register(_end)
    sys.unraisablehook = _keep_interrupts
    try:
        from tipoff.studies.cli import app

        app()
    except KeyboardInterrupt:
        print("tipoff: stopped", file=sys.stderr)
        sys.exit(130)
    except OSError as error:
        print(f"tipoff: {error}", file=sys.stderr)
        sys.exit(1)


def _end() -> None:
    """Ignore Ctrl-C once all work is done: it would end the process by the signal, with the exit code of
    a command that was stopped. Python looks for garbage at its end, which takes a tenth of a second, and
    the memory goes back anyway."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()


def _keep_interrupts(dropped: "sys.UnraisableHookArgs") -> None:
    """Send Ctrl-C again after a callback has ended. Python ignores exceptions in a destructor or in
    the callback of a weak reference, including KeyboardInterrupt, and an import runs many of
    them."""
    if not issubclass(dropped.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(dropped)
        return
    main_thread = threading.main_thread().ident
    threading.Timer(0.01, signal.pthread_kill, (main_thread, signal.SIGINT)).start()


def _one_thread_of_blas() -> None:
    """Set BLAS to one thread, before NumPy loads. The matrices of this program are small: more
    threads wait for each other and take the cores of the kernels and of parallel runs."""
    for library in ("OPENBLAS", "MKL", "BLIS"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")


if __name__ == "__main__":
    main()
