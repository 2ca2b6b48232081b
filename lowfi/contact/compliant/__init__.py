"""Walls that give way: pads pressed through cells of their faces on the static flexibility of the
rail (data: ``mechanics.rail_compliance``)."""
