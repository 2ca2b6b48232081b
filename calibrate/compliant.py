"""Constants of compliant contact that a fit may determine: usually not measured, and not given by
the statics of the rail.

The interface stiffness is known to a factor (``docs/interface_stiffness.md``), as is the stiffness
of bolted mounts (``docs/mount_stiffness.md``). Friction and clearance are known to a tolerance. The
rail compliance comes from the finite elements and is not fitted.
"""

from tipoff.calibration.parameters import Parameter, friction
from tipoff.mechanics.rail_compliance.joint_terms import LEAST, MOST
from tipoff.scenes.effects.contact import ContactTable
from tipoff.scenes.scene import Scene

_INTERFACE = 16.0  # factor in both directions
CLEARANCE = "contact.clearance"
AXES = (f"{CLEARANCE}_y", f"{CLEARANCE}_z")
KEYS = (
    "contact.interface_stiffness",
    CLEARANCE,
    *AXES,
    "rail.mount_stiffness.factor",
    "friction.dynamic",
)


def free(scene: Scene) -> list[Parameter]:
    """The constants of the contact of ``scene``: interface stiffness; clearance if it is above zero
    (along both axes if each has its own); stiffness of the mounts if they are not rigid; friction
    if there is any. None without contact."""
    contact = scene.contact
    if contact is None:
        return []
    found = [_interface_stiffness(contact)]
    if None not in (contact.clearance_y, contact.clearance_z):
        found += along_axes(scene)
    elif contact.clearance > 0.0:
        found.append(_clearance(CLEARANCE, contact.clearance, "", lambda c: c.clearance))
    if scene.rail.mount_stiffness is not None:
        found.append(_mounts())
    return [*found, friction(scene)] if scene.friction is not None else found


def along_axes(scene: Scene) -> list[Parameter]:
    """Clearances of the faces along y and along z, for a fit of separate values."""
    contact = scene.contact
    if contact is None:
        return []
    return [
        _clearance(
            name, contact.gaps()[axis], f" along {name[-1]}", lambda c, axis=axis: c.gaps()[axis]
        )
        for axis, name in enumerate(AXES, start=1)
        if contact.gaps()[axis] > 0.0
    ]


def needs(name: str) -> str:
    """Text of what a scene needs for the parameter ``name``."""
    if name == CLEARANCE:
        return f"a clearance above zero and an axis without its own ({' and '.join(AXES)})"
    if name.startswith("initial.") or name in AXES:
        return "a clearance above zero"
    if name.startswith("payload.inertia."):
        return "an inertia tensor that leaves room for changes"
    table = "[rail.mount_stiffness]" if name.startswith("rail.") else f"[{name.split('.')[0]}]"
    return f"the table {table}"


def _contact(scene: Scene) -> ContactTable:
    assert scene.contact is not None
    return scene.contact


def _interface_stiffness(contact: ContactTable) -> Parameter:
    return Parameter(
        name="contact.interface_stiffness",
        unit="N/m**3",
        lower=contact.interface_stiffness / _INTERFACE,
        upper=contact.interface_stiffness * _INTERFACE,
        logarithmic=True,
        justification=f"{_INTERFACE:g} times less to {_INTERFACE:g} times more than the scene's: roughness and "
        "pressure change it by two orders of magnitude (docs/interface_stiffness.md)",
        read=lambda s: _contact(s).interface_stiffness,
    )


def _clearance(name: str, own: float, where: str, read) -> Parameter:
    return Parameter(
        name=name,
        unit="m",
        lower=0.0,
        upper=2.0 * own,
        logarithmic=False,
        justification=f"from none to twice the scene's{where}",
        read=lambda s: read(_contact(s)),
    )


def _mounts() -> Parameter:
    def read(scene: Scene) -> float:
        assert scene.rail.mount_stiffness is not None
        return scene.rail.mount_stiffness.factor

    return Parameter(
        name="rail.mount_stiffness.factor",
        unit="1",
        lower=LEAST,
        upper=MOST,
        logarithmic=True,
        justification="the factors that one rail compliance serves: bolts between hand-tight and their yield, "
        "rough and ground surfaces",
        read=read,
    )
