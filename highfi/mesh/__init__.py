"""Rail mesh as data: its checks, facets, separate solids and refinement."""
