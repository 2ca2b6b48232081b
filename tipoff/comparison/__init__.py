"""How two runs are compared, and what the runs of several meshes say about each other."""
