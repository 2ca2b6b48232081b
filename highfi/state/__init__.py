"""Records of the time loop, poses, loops over the nodes, threads."""
