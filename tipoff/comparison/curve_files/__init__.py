"""Files with curves of other codes: tables of text, LS-DYNA, Adams. ``reading`` is the entry."""
