"""The inputs of a scene: as written, resolved in SI, and the hash of those that determine a result."""

from pathlib import Path
from typing import Any

from tipoff.files import content_hash
from tipoff.scenes import overrides as keys
from tipoff.scenes.parts import expansion
from tipoff.scenes.reading import CATALOG

# the flight after the exit does not change the ejection, and no solver reads [studies]
_BESIDE = ("conditions", "agreement", "provenance")
_NOT_PHYSICS = {"name", "description", "flight", "hand_over", "studies", *_BESIDE}


class Inputs:
    """Base of ``scenes.scene.Scene``: its inputs."""

    def given(self: Any, key: str) -> Any:
        """The input under a dotted ``key`` as it was written, with its unit; None without one."""
        found: Any = self._raw
        for part in key.split("."):
            found = found.get(part) if isinstance(found, dict) else None
        return found

    def written_out(self: Any) -> dict:
        """The input as it would be written without parts: pads, play and places by hand, with units."""
        return expansion.written_out(self._raw)

    def physics(self: Any) -> dict:
        """The physical inputs in SI that determine a result, without names and roles."""
        found = self.model_dump(mode="json", exclude=_NOT_PHYSICS)
        if self.thermal is None:
            found["rail"]["material"].pop("expansion", None)
        return found

    def resolved(self: Any) -> dict:
        """Every input in SI, as written into result files.

        Returns:
            dict: tables by name; ``parse(..., bare_numbers_are_si=True)`` reads it back.

        Example:
            >>> scene = tipoff.load("tiny")
            >>> tipoff.parse(scene.resolved(), bare_numbers_are_si=True).hash == scene.hash
            True
        """
        found = self.model_dump(mode="json", exclude_none=True)
        for key, value in expansion.as_written(self._raw).items():
            keys.apply(found, key, value)
        return found

    @property
    def source(self: Any) -> str:
        """The name in the catalogue, or the path of the file of the scene."""
        path = Path(self._source)
        return path.stem if path.parent == CATALOG else self._source

    @property  # a copy of the scene, and one that ``Variations`` overwrites, must not keep it
    def hash(self: Any) -> str:
        """SHA-256 of the physical inputs. A file counts by its content, and a measured thrust by
        its points, not by their paths."""
        physics = self.physics()
        physics["rail"] |= self.rail.contents()
        physics["thrust"], points = self.thrust.contents()
        return content_hash(physics, points)
