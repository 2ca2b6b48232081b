"""Commands with options of their own, one file each: ``add(app)`` puts it under ``tipoff``."""
