"""The effects a scene can call for: one file each, with its table (units), its kernel record, its
law and its null meaning.

The record of an absent effect is ``None``. Kernels take each record as an argument, so Numba prunes
what is absent.
"""
