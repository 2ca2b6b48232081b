"""Seeded mutants of everything a user gives: scenes, meshes, solids, tables, logs, calibrations.

Each mutant must end with exit code 0, 1 or 2 and without a traceback. ``test_mutants`` runs some
hundred of them; ``make fuzz`` runs ten thousand under limits of time and memory, and attacks whole
commands.
"""
