"""Sections of extruded rails: outlines given by corners, by a drawing, or by a few numbers."""
