"""The effects of a scene: one file each, with its table (units), how the table becomes the record of
its law (``mechanics.laws``), and the meaning of an absent table. ``registry`` lists them.

The record of an absent effect is ``None``. Kernels take each record as an argument, so that Numba
removes the code of an absent effect.
"""
