"""Files with curves of other codes; each is written here from the public description of its format."""
