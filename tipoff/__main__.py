"""``python -m tipoff`` and the command ``tipoff``."""

import atexit
import codecs
import gc
import io
import os
import signal
import sys
import threading
import unicodedata

# New objects before a collection of garbage, and collections of each older generation. The modules of
# a command make 100,000 objects that stay: to look through them takes a tenth of a short command.
_RARE = 20_000, 50, 50
# Plain spellings of the characters that this program prints, for encodings that lack them.
_PLAIN = {"µ": "u", "±": "+-", "×": "x", "·": "*", "√": "sqrt ", "✓": "yes", "✗": "no", "°": " deg"}
_PLAIN |= dict.fromkeys("“”", '"')


def main() -> None:
    """Run the command line. The exit code is 130 after Ctrl-C, and 1 if the machine refuses a file,
    even while modules load."""
    _one_thread_of_blas()
    _print_in_any_encoding()
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


def _print_in_any_encoding() -> None:
    """Let both output streams spell a character that their encoding lacks. Python raises an error
    instead, after all work is done."""
    codecs.register_error("tipoff", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # None if it is closed
            stream.reconfigure(errors="tipoff")


def _spelled(fault: UnicodeError) -> tuple[str | bytes, int]:
    """The first character that cannot be encoded in plain letters, and the place after it. A byte of
    a file name that is not text stays that byte."""
    if not isinstance(fault, UnicodeEncodeError):
        raise fault
    character, after = fault.object[fault.start], fault.start + 1
    if "\udc80" <= character <= "\udcff":
        return bytes([ord(character) - 0xDC00]), after
    if character in _PLAIN:
        return _PLAIN[character], after
    name = unicodedata.name(character, "")
    if name.startswith("BOX DRAWINGS"):
        ends = any(word in name for word in ("AND", "ARC", "DIAGONAL"))
        return "+" if ends else "|" if "VERTICAL" in name else "-", after
    if "DASH" in name or "MINUS" in name:
        return "-", after
    letters = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return letters or "?", after


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
