"""Which effects a compiled kernel contains, read from its machine code."""

from collections.abc import Callable, Mapping

from tipoff.kernels.jit import contains, machine_code


def effects(kernel: Callable, arguments: tuple, laws: Mapping[str, object]) -> dict[str, bool]:
    """For each effect of ``laws``, whether ``kernel``, compiled for the types of ``arguments``,
    contains its law: a kernel that only this effect calls. Raises RuntimeError without a cache of
    compiled kernels."""
    code = machine_code(kernel, arguments)
    return {effect: contains(code, law) for effect, law in laws.items()}
