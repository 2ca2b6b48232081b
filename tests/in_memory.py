"""A cache in memory: to write a result takes longer than to make a synthetic one."""

from tipoff.cache import Cache


def memory(kept: dict | None = None, files: Cache | None = None, written: int = 0) -> Cache:
    """Results in ``kept``, beside empty files, or in the place of the cache ``files``, by which the first
    ``written`` results become files too."""
    kept = {} if kept is None else kept

    def read(path, key):
        if (path, key) not in kept:
            raise FileNotFoundError(path)
        return kept[path, key]

    def write(path, key, value):
        if files is None:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        elif len(kept) < written:
            files.put(path, key, value)
        kept[path, key] = value
        return value

    return Cache(read, write)
