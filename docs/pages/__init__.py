"""Parts of the documentation that are made from the code: keys of a scene, commands."""
