"""One law a file, over numpy and kernels only: record, force, energy. ``scenes.effects`` has the tables
that become these records.
"""
