"""Readers of mesh files, one file for each format. A reader gives a ``meshio.Mesh`` whose
``cell_sets`` has every named group, and raises ``Unreadable``."""
