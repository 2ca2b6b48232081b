"""Sections of a gmsh file as streams of numbers, in text and in binary."""

import numpy as np

from tipoff.formats.meshes.blocks import Unreadable

# types of numbers in binary files, by their meaning in the description of the format
INT, REAL = "i4", "f8"
_NAMES = {INT: "an integer", REAL: "a number"}


class Section:
    """Numbers of one section, read one after the other. A count is a fault if the section does not
    have so many numbers."""

    def __init__(self, name: str) -> None:
        self.name = name

    def take(self, count: int, kind: str = INT) -> np.ndarray:
        """The next ``count`` numbers. Raises Unreadable if the section has fewer."""
        raise NotImplementedError

    def rows(self, count: int, *kinds: tuple[str, int]) -> list[np.ndarray]:
        """``count`` records of numbers: an array (count,m) for each pair of a kind and the number m
        of its values in a record."""
        raise NotImplementedError

    def one(self, kind: str = INT) -> int:
        """The next number, a count or a tag."""
        return int(self.take(1, kind)[0])

    def counts(self, number: int, kind: str = INT) -> list[int]:
        """The next ``number`` counts. Raises Unreadable for a negative one."""
        found = self.take(number, kind).tolist()
        if min(found) < 0:
            raise Unreadable(f"${self.name} has a negative count")
        return found

    def _short(self) -> Unreadable:
        return Unreadable(f"${self.name} is shorter than its counts say")


class Text(Section):
    """A section of words."""

    def __init__(self, name: str, words: list[bytes]) -> None:
        super().__init__(name)
        self._words, self._at = words, 0

    def take(self, count: int, kind: str = INT) -> np.ndarray:
        """As ``Section.take``."""
        if not 0 <= count <= len(self._words) - self._at:
            raise self._short()
        words = self._words[self._at : self._at + count]
        self._at += count
        return self._numbers(words, kind)

    def rows(self, count: int, *kinds: tuple[str, int]) -> list[np.ndarray]:
        """As ``Section.rows``."""
        width = sum(number for _, number in kinds)
        if not 0 <= count * width <= len(self._words) - self._at:
            raise self._short()
        words = self._words[self._at : self._at + count * width]
        self._at += count * width
        table, start, found = np.array(words, dtype=object).reshape(count, width), 0, []
        for kind, number in kinds:
            part = self._numbers(table[:, start : start + number].ravel().tolist(), kind)
            found.append(part.reshape(count, number))
            start += number
        return found

    def _numbers(self, words: list[bytes], kind: str) -> np.ndarray:
        try:
            if kind == REAL:
                return np.array([float(word) for word in words])
            return np.array([int(word) for word in words], dtype=np.int64)
        except (ValueError, OverflowError) as fault:
            wrong = next(word for word in words if not _is_number(word, kind))
            text = wrong[:40].decode(errors="replace")
            raise Unreadable(f"${self.name} has {text!r} in place of {_NAMES[kind]}") from fault


def _is_number(word: bytes, kind: str) -> bool:
    try:
        return bool(float(word) or True) if kind == REAL else abs(int(word)) < 2**63
    except ValueError:
        return False


class Binary(Section):
    """A section of bytes. ``order`` is the byte order of numbers, ``size`` the number of bytes of
    the format's size_t."""

    def __init__(self, name: str, content: memoryview, order: str, size: int) -> None:
        super().__init__(name)
        self._content, self.at = content, 0
        self._order, self._size = order, f"u{size}"

    def _type(self, kind: str) -> np.dtype:
        return np.dtype(self._order + (self._size if kind == "size" else kind))

    def _bytes(self, count: int, each: int) -> memoryview:
        if not 0 <= count * each <= len(self._content) - self.at:
            raise self._short()
        self.at += count * each
        return self._content[self.at - count * each : self.at]

    def take(self, count: int, kind: str = INT) -> np.ndarray:
        """As ``Section.take``."""
        dtype = self._type(kind)
        found = np.frombuffer(self._bytes(count, dtype.itemsize), dtype)
        return found.astype(float) if kind == REAL else _whole(found)

    def rows(self, count: int, *kinds: tuple[str, int]) -> list[np.ndarray]:
        """As ``Section.rows``."""
        record = np.dtype(
            [
                (str(place), self._type(kind), (number,))
                for place, (kind, number) in enumerate(kinds)
            ]
        )
        found = np.frombuffer(self._bytes(count, record.itemsize), record)
        return [
            found[str(place)].astype(float) if kind == REAL else _whole(found[str(place)])
            for place, (kind, _) in enumerate(kinds)
        ]


def _whole(found: np.ndarray) -> np.ndarray:
    # An unsigned number that does not fit is negative here, so it is no valid number of anything.
    return found.astype(np.int64)
