"""Files of others: every reader turns one into plain values, arrays and small records.

``meshes``, ``sections``, ``thrusts``, ``curves`` and ``logs`` are the rooms; tables of text, which several
of them read, are in ``instrument_table`` and ``csv_file``. What the values are used for lies elsewhere, and
nothing here imports it.
"""
