"""The model ``springs`` in Exudyn: two rigid bodies of its own, and the forces of pads and thrust as user
functions in Python.

Exudyn has no contact with the law IMPACT, so a user function writes it out, from the definitions in the
manual of ADAMS/Solver. It shares no code with the surrogate. The bodies, their rotations (angles of
Tait and Bryan) and the integrators are Exudyn's.
"""

import math
import time as clock
from typing import Any, NamedTuple

import numpy as np

from validation.peers.case import PeerMissing, require_count, require_finished
from validation.peers.springs_problem import Problem

FIXED, ADAPTIVE = "RK44", "DOPRI5"
# s, bounds of an adaptive step: the largest does not miss a contact, the smallest resolves a touch
_LONGEST, _SHORTEST = 2e-4, 1e-12


class Samples(NamedTuple):
    """Samples of the payload's motion, and processor time (s)."""

    time: np.ndarray  # (n,) s
    rate: np.ndarray  # (n,3) rad/s, body axes
    cpu_s: float


class Law(NamedTuple):
    """Constants of a contact and its friction; ``depth`` (m) is None for a linear damper."""

    stiffness: float  # N/m^e
    exponent: float
    damping: float  # N s/m
    depth: float | None
    friction: float  # coefficient, static and dynamic
    slip: float  # m/s, at which it is fully reached


def engine() -> Any:
    """The module ``exudyn``. Raises PeerMissing."""
    try:
        import exudyn
    except ImportError as error:
        raise PeerMissing(f"exudyn does not load ({error}); pip install 'tipoff[peers]'") from error
    return exudyn


def version() -> str:
    """Version of Exudyn. Raises PeerMissing."""
    return engine().config.Version()


class Wrench:
    """Forces and moments on both bodies, about their mass centres in scene axes. The last state is
    kept, because Exudyn requests each of the four vectors separately."""

    def __init__(self, problem: Problem, law: Law):
        self.problem, self.law = problem, law
        self.axis = np.abs(problem.normals).argmax(axis=1)
        self.sign = problem.normals.sum(axis=1)
        self.key: tuple = ()
        self.parts = (np.zeros(3),) * 4

    def at(self, time: float, payload: tuple, platform: tuple) -> tuple:
        """Force and moment on the payload, force and moment on the platform. A body is its place,
        rotation matrix, velocity and rate, in scene axes."""
        problem = self.problem
        place, turn, velocity, rate = payload
        base, frame, drift, spin = platform
        force = turn @ (problem.thrust(time) * np.array(problem.direction))
        point = place + turn @ np.array(problem.arm)
        total = [force, np.cross(point - place, force), -force, -np.cross(point - base, force)]
        points = place + problem.points @ turn.T
        seen = (points - base) @ frame
        rows = np.arange(len(seen))
        depth = self.sign * seen[rows, self.axis] - problem.walls
        low, high = problem.ends
        for i in np.flatnonzero((depth > 0.0) & (seen[:, 0] >= low) & (seen[:, 0] <= high)):
            moving = velocity + np.cross(rate, points[i] - place)
            carried = drift + np.cross(spin, points[i] - base)
            push = frame @ self.force(depth[i], problem.normals[i], (moving - carried) @ frame)
            total[0] = total[0] + push
            total[1] = total[1] + np.cross(points[i] - place, push)
            total[2] = total[2] - push
            total[3] = total[3] - np.cross(points[i] - base, push)
        return tuple(total)

    def force(self, depth: float, normal: np.ndarray, slide: np.ndarray) -> np.ndarray:
        """Force (3,) N of one face in platform axes."""
        law, closing = self.law, float(normal @ slide)
        damping = law.damping
        if law.depth is not None:
            x = min(depth / law.depth, 1.0)
            damping *= x * x * (3.0 - 2.0 * x)
        size = max(0.0, law.stiffness * depth**law.exponent + damping * closing)
        across = slide - closing * normal
        speed = math.sqrt(float(across @ across))
        found = -size * normal
        if law.friction and speed > 0.0:
            r = min(speed / law.slip, 1.0)
            found = found - law.friction * 0.5 * r * (3.0 - r * r) * size * across / speed
        return found


def run(problem: Problem, law: Law, method: str, setting: float, until: float) -> Samples:
    """Motion to the time ``until`` (s); ``setting`` is the step (s) of the ``method`` RK44 or the
    relative tolerance of DOPRI5."""
    exudyn = engine()
    from exudyn import itemInterface as items

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    wrench, nodes, markers = Wrench(problem, law), [], []
    for place, mass, inertia in (
        (problem.place, problem.mass, problem.inertia),
        (problem.platform_place, problem.platform_mass, problem.platform_inertia),
    ):
        tensor = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        nodes.append(
            system.AddNode(items.NodeRigidBodyRxyz(referenceCoordinates=[*place, 0.0, 0.0, 0.0]))
        )
        body = system.AddObject(
            items.ObjectRigidBody(mass=mass, inertia=tensor, nodeNumber=nodes[-1])
        )
        markers.append(system.AddMarker(items.MarkerBodyRigid(bodyNumber=body)))
    kinds = exudyn.OutputVariableType

    def state(node: int) -> tuple:
        return (
            system.GetNodeOutput(node, kinds.Position),
            system.GetNodeOutput(node, kinds.RotationMatrix).reshape(3, 3),
            system.GetNodeOutput(node, kinds.Velocity),
            system.GetNodeOutput(node, kinds.AngularVelocity),
        )

    def part(index: int):
        def vector(_, time: float, __) -> list[float]:
            data = system.systemData
            key = time, data.GetODE2Coordinates().tobytes(), data.GetODE2Coordinates_t().tobytes()
            if key != wrench.key:
                wrench.parts = wrench.at(time, state(nodes[0]), state(nodes[1]))
                wrench.key = key
            return wrench.parts[index].tolist()

        return vector

    for index, marker in enumerate((markers[0], markers[0], markers[1], markers[1])):
        kind = (items.LoadForceVector, items.LoadTorqueVector)[index % 2]
        system.AddLoad(kind(markerNumber=marker, loadVectorUserFunction=part(index)))
    sensor = system.AddSensor(
        items.SensorNode(
            nodeNumber=nodes[0], outputVariableType=kinds.AngularVelocityLocal, storeInternal=True
        )
    )
    system.Assemble()
    began = clock.thread_time()
    chosen = _settings(exudyn, method, setting, until)
    system.SolveDynamic(chosen, solverType=getattr(exudyn.DynamicSolverType, method))
    spent = clock.thread_time() - began
    table = system.GetSensorStoredData(sensor)
    steps = chosen.timeIntegration
    require_finished("Exudyn", float(table[-1, 0]), steps.endTime, table)
    if method == FIXED:
        require_count("Exudyn", "steps", len(table) - 1, steps.numberOfSteps)
    return Samples(table[:, 0], table[:, 1:4], spent)


def _settings(exudyn, method: str, setting: float, until: float):
    chosen = exudyn.SimulationSettings()
    steps = chosen.timeIntegration
    steps.endTime = until
    steps.verboseMode = 0
    chosen.solution.file.write = False
    chosen.solution.sensors.writePeriod = 1e-9  # after every step
    if method == FIXED:
        steps.numberOfSteps = math.ceil(until / setting - 1e-9)
        steps.endTime = steps.numberOfSteps * setting
    else:
        steps.numberOfSteps = math.ceil(until / _LONGEST)
        steps.automaticStepSize = True
        steps.minimumStepSize = _SHORTEST
        steps.relativeTolerance, steps.absoluteTolerance = setting, 1e-3 * setting
    return chosen
