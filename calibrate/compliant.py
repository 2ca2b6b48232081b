"""The parameters of a fit on compliant contact. They are usually not measured, and the statics of the
rail do not give them.

The interface stiffness is known to a factor (``docs/interface_stiffness.md``), as is the stiffness
of bolted mounts (``docs/mount_stiffness.md``). Friction and clearance are known to a tolerance. The
rail compliance comes from the finite elements and is not fitted.
"""

from tipoff.calibration.parameters import Parameter, friction
from tipoff.mechanics.joint_terms import LEAST, MOST
from tipoff.scenes.effects.contact import ContactTable
from tipoff.scenes.scene import Scene

_INTERFACE = 16.0  # either way


def free(scene: Scene) -> list[Parameter]:
    """The parameters of the fit of ``scene``, which has contact: interface stiffness, clearance
    where there is any, stiffness of the mounts where they are no rigid clamps, and friction if there
    is any."""
    found = [_interface_stiffness(scene)]
    if _contact(scene).clearance > 0.0:
        found.append(_clearance(scene))
    if scene.rail.mount_stiffness is not None:
        found.append(_mounts())
    return [*found, friction(scene)] if scene.friction is not None else found


def _contact(scene: Scene) -> ContactTable:
    assert scene.contact is not None
    return scene.contact


def _interface_stiffness(scene: Scene) -> Parameter:
    stiffness = _contact(scene).interface_stiffness
    return Parameter(
        "contact.interface_stiffness",
        "N/m**3",
        stiffness / _INTERFACE,
        stiffness * _INTERFACE,
        True,
        f"{_INTERFACE:g} times less to {_INTERFACE:g} times more than the scene's: roughness and "
        "pressure change it by two orders of magnitude (docs/interface_stiffness.md)",
        lambda s: _contact(s).interface_stiffness,
    )


def _clearance(scene: Scene) -> Parameter:
    return Parameter(
        "contact.clearance",
        "m",
        0.0,
        2.0 * _contact(scene).clearance,
        False,
        "from none to twice the scene's",
        lambda s: _contact(s).clearance,
    )


def _mounts() -> Parameter:
    def read(scene: Scene) -> float:
        assert scene.rail.mount_stiffness is not None
        return scene.rail.mount_stiffness.factor

    return Parameter(
        "rail.mount_stiffness.factor",
        "1",
        LEAST,
        MOST,
        True,
        "the factors that one rail compliance serves: bolts between hand-tight and their yield, "
        "rough and ground surfaces",
        read,
    )
