"""What the page computes for a scene: a quick run while a slider moves, and the run itself when it rests."""

import tipoff


def compliance(scene: tipoff.Scene) -> tipoff.RailCompliance | None:
    """Compliance of the rails, from the cache of the user or from finite elements; None for a scene
    without contact. It does not depend on any value that the page changes."""
    return tipoff.compliance(scene) if scene.contact is not None else None


def quick(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene`` from rails without inertia, a tenth of the time of ``run`` where the
    rails vibrate. Raises SceneError."""
    return tipoff.run(scene, compliance=found, sensitivity=False, modes=0)


def run(scene: tipoff.Scene, found: tipoff.RailCompliance | None) -> tipoff.Trajectory:
    """The ejection of ``scene``, with as many modes of the rails as its rates need, and with its error. Raises
    SceneError."""
    return tipoff.run(scene, compliance=found)
