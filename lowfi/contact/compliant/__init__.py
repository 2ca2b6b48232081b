"""Compliant contact: the cells of pad faces on the static flexibility of the rail (data:
``mechanics.rail_compliance``)."""
