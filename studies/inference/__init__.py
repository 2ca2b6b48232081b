"""What the unpublished inputs of the paper must have been: unknowns with physical bounds, its
printed rates, and the sets that give them."""
