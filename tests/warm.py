"""Compiles the time loops that several test files share, each once, on all cores.

    python -m tests.warm

Workers of pytest that meet the same kernel at the same time would each compile it.
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from tests.highfi.support import COARSE, tiny
from tests.lowfi.compliance import REFERENCE, reference_compliance
from tests.lowfi.support import PAPER_PAD, scene
from tipoff import highfi, lowfi

LINEAR = {"law": "linear", "clearance": 1e-5, "stiffness": 7e7, "damping": 0.0}


def finite_elements() -> None:
    """The reference on the small scene."""
    highfi.run(tiny(), COARSE)


def compliant() -> None:
    """The surrogate on compliant rails."""
    lowfi.run(REFERENCE, "compliant", compliance=reference_compliance())


def springs() -> None:
    """The surrogate on springs."""
    lowfi.run(REFERENCE, "springs")


def body_on_impact() -> None:
    """One body on the contact law of the paper."""
    lowfi.run(scene(1e-3, 1e-3, contact=PAPER_PAD), "springs")


def body_on_linear() -> None:
    """One body on a linear contact law."""
    lowfi.run(scene(1e-3, 1e-3, contact=LINEAR), "springs")


def free_body() -> None:
    """One body without contact."""
    lowfi.run(scene(1e-3, 1e-3), "springs")


if __name__ == "__main__":
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        loops = (finite_elements, compliant, springs, body_on_impact, body_on_linear, free_body)
        for done in [pool.submit(loop) for loop in loops]:
            done.result()
