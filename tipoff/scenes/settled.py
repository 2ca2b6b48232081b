"""Check of scenes whose payload rests on its rails at ignition (``initial.settled``)."""

from typing import Any

from tipoff.faults import Fault, SceneError
from tipoff.mechanics.laws.initial import Initial
from tipoff.scenes.effects import registry
from tipoff.scenes.effects.spring import PushedTable


def is_settled(scene: Any) -> bool:
    """Whether the payload rests on its rails at ignition."""
    return scene.initial is not None and scene.initial.settled


def require(scene: Any) -> None:
    """Raise SceneError, with every fault, for a payload that is settled but cannot rest on
    rails."""
    if not is_settled(scene):
        return
    found = []
    if scene.platform is not None:
        found.append(("platform", "a free platform", "none: it falls with its payload"))
    elif registry.body_force(scene) is None:
        found.append(("gravity", "nothing", "a weight that holds the payload on its rails"))
    if scene.contact is None:
        found.append(("contact", "nothing", "walls on which the payload rests"))
    if isinstance(scene.thrust, PushedTable):
        found.append(("thrust.kind", repr(scene.thrust.kind), "a thrust over time"))
    own, rest = scene.initial.record(), Initial()
    if own.velocity != rest.velocity or own.rate != rest.rate:
        found.append(("initial", "a velocity or a rate", "none: a settled payload is at rest"))
    if found:
        raise SceneError(
            [
                Fault(scene.name, key, given, f"{words} (initial.settled)")
                for key, given, words in found
            ]
        )


def no_rest(name: str, words: str) -> SceneError:
    """The fault of the scene ``name`` whose payload finds no place of rest."""
    expected = "walls and a weight that hold the payload in one place"
    return SceneError([Fault(name, "initial.settled", words, expected)])
