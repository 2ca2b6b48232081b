"""A run to look at: VTK files of its frames for ParaView, and pictures of them where pyvista is
installed."""
