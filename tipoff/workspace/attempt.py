"""One part of a larger result, such as a section of a page: other parts continue if it fails. The
reason is a sentence of the result; an error of the program prints its traceback."""

import errno
import traceback
from collections.abc import Callable
from typing import TypeVar

from tipoff.faults import InputError
from tipoff.workspace.errors import StudyError
from tipoff.workspace.progress import say

_T = TypeVar("_T")
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)  # nothing else could be written either


def attempt(
    name: str, work: Callable[[], _T], passing: type[Exception] | tuple[type[Exception], ...] = ()
) -> tuple[_T | None, str]:
    """The result of ``work`` and an empty reason; or None and the reason of an exception.

    The part ``name`` and the reason are printed, with the traceback of an error of the program. The
    exceptions ``passing``, KeyboardInterrupt and a disk that cannot be written are raised.
    """
    try:
        return work(), ""
    except passing:
        raise
    except Exception as fault:
        if isinstance(fault, OSError) and fault.errno in _NO_ROOM:
            raise
        if isinstance(fault, (StudyError, InputError)):
            reason = str(fault)
        else:
            say(traceback.format_exc().rstrip())
            reason = ": ".join(filter(None, [type(fault).__name__, " ".join(str(fault).split())]))
        say(f"{name} failed: {reason}")
        return None, reason
