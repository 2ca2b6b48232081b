"""Readers of mesh files, one file for each format. A reader gives a ``meshio.Mesh`` whose
``cell_sets`` has every group of elements and ``point_sets`` every group of nodes, and raises
``Unreadable``."""
