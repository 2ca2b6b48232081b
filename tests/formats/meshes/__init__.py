"""The same small rail in files of every format."""
