"""The rail mesh as data, checked, and what is derived from it: facets, pieces, finer meshes."""
