"""The result of one run, the same for all models: names, units and coordinates, and a netCDF file
of it.

Positions and velocities are of the payload's mass centre, inertial, in initial scene axes; rates
are in body axes; quaternions are scalar first, body to inertial. Ledgers and momenta are in the
frame of the solution, which keeps the velocity of the platform's mass centre at ignition
(``mechanics.comoving``).
"""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from tipoff import sources
from tipoff.cards import Carded
from tipoff.files import (
    FORMAT_KEY,
    DamageError,
    require_format,
    require_whole,
    write_csv,
    write_sealed,
)
from tipoff.mechanics import ledger, outcome
from tipoff.mechanics.model_names import MODELS
from tipoff.results import finite, guides, hand_calculation, hand_over, shown
from tipoff.results.completion import Completed
from tipoff.results.contents import (
    DIMENSIONS,
    OPTIONAL,
    PLAIN,
    STRESS,
    VECTOR,
    attributes,
    content,
    variables,
)
from tipoff.results.model_error import ModelError

if TYPE_CHECKING:
    import xarray

    from tipoff.plots import Figure

STATUSES = ("exited", "time_limit", "jammed", "diverged", "refused")
_CHECKED = ("checks", "cost", "numerics", "stress")  # not the scene, which is finite
_PLOTTED = {"rate": ("deg/s", 180.0 / math.pi), "velocity": ("m/s", 1.0), "position": ("mm", 1e3)}


def versions() -> dict[str, str]:
    """Versions of the libraries that determine a result."""
    names = ("tipoff", "numpy", "scipy", "numba", "scikit-fem", "gmsh")
    return {name: sources.version(name) for name in names}


@dataclass(frozen=True, eq=False)
class Trajectory(Carded, Completed):
    """Sampled motion of payload and platform, pad forces and both energy ledgers, of n samples. A
    diverged or refused run has no settled values.

    Raises:
        ValueError: another model or status, arrays that do not fit each other, and NaN or inf, with
            their place.

    Example:
        >>> run = tipoff.run(tipoff.load("tiny"), "springs")
        >>> run.rate.shape == (run.time.size, 3)
        True
    """

    PUT_OFF: ClassVar = "checks", "message", "error"

    #: One of ``mechanics.model_names.MODELS``.
    model: str
    status: str
    #: (n,) s.
    time: np.ndarray
    #: (n,3) m.
    position: np.ndarray
    #: (n,3) m/s.
    velocity: np.ndarray
    #: (n,4).
    quaternion: np.ndarray
    #: (n,3) rad/s.
    rate: np.ndarray
    platform_position: np.ndarray
    platform_velocity: np.ndarray
    platform_quaternion: np.ndarray
    platform_rate: np.ndarray
    #: (n,f,3) N, on the payload, in scene axes.
    pad_force: np.ndarray
    #: (n, len(ledger.ENTRIES)) J, total ledger.
    energy: np.ndarray
    #: The transverse ledger.
    transverse_energy: np.ndarray
    outcome: outcome.Outcome
    #: Relative errors of the balances.
    checks: dict[str, float]
    #: wall_s, compile_s, steps, dt_s and values of the model.
    cost: dict[str, Any]
    #: Resolved inputs.
    scene: dict
    message: str = field(default_factory=str)
    #: Error of the rates by the model; only of a surrogate with ``sensitivity``.
    error: ModelError | None = field(default_factory=type(None))
    numerics: dict = field(default_factory=dict)
    #: Stress of flexible rails, None for rigid rails and diverged runs. It has peak_stress_pa, the
    #: largest von Mises stress, at peak_stress_place_m (scene axes, undeformed) of peak_stress_rail
    #: at peak_stress_time_s; yield_strength_pa or None; largest_strain, largest_rotation_rad;
    #: warnings, texts on doubts about these; patch_places_m of the w patches.
    stress: dict | None = None
    #: (n,w,6) Pa, mean stress of the patches, in platform axes.
    wall_stress: np.ndarray | None = None
    #: Largest load of each of g guides: (g,) s, (g,3) N, and its moment about the mass centre (g,3) N m,
    #: in body axes. ``guides`` has them by name.
    guide_time: np.ndarray = field(default_factory=lambda: np.zeros(0))
    guide_force: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    guide_moment: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    versions: dict[str, str] = field(default_factory=versions)

    def __post_init__(self):
        if self.status not in STATUSES:
            raise ValueError(f"status {self.status!r}, expected one of {STATUSES}")
        if self.model not in MODELS:
            raise ValueError(f"model {self.model!r}, expected one of {MODELS}")
        if self.wall_stress is None:
            object.__setattr__(self, "wall_stress", np.zeros((np.size(self.time), 0, len(STRESS))))
        widths = {
            "stress_component": len(STRESS),
            "axis": 3,
            "component": 4,
            "entry": len(ledger.ENTRIES),
            "time": np.size(self.time),
        }
        for name, dimensions in ({"time": ("time",)} | DIMENSIONS).items():
            shape = np.shape(getattr(self, name))
            if len(shape) != len(dimensions) or any(
                widths.get(d, n) != n for d, n in zip(dimensions, shape)
            ):
                raise ValueError(f"{name} has shape {shape}, expected {dimensions} with {widths}")
            if not np.isfinite(getattr(self, name)).all():
                raise ValueError(
                    f"{name} holds NaN or inf: a run must stop before it reaches a result"
                )
        if (np.diff(self.time) < 0.0).any():
            raise ValueError("time falls, expected samples in their order")
        outcome.require(self.outcome)
        found = {name: getattr(self, name) for name in _CHECKED} | {
            "outcome": self.outcome._asdict()
        }
        if not finite.is_finite(found):
            lost = [
                ".".join(path)
                for path, number in finite.numbers(found)
                if not math.isfinite(number)
            ]
            raise ValueError(
                f"{', '.join(lost)}: NaN or inf, which no result may hold (None says that there is "
                f"no value)"
            )

    def __repr__(self) -> str:
        return shown.line(self)

    def _facts(self) -> dict[str, str]:
        return shown.facts(self)

    def plot(self, quantity: str = "rate", axes: Any = None) -> "Figure":
        """Draw the three components of a ``quantity`` over the time after ignition (ms).

        Args:
            quantity: ``rate`` (deg/s, inertial, in body axes), ``velocity`` (m/s) or ``position``
                (mm), both inertial in scene axes.
            axes: matplotlib axes to draw in; a new figure by default.

        Returns:
            Figure: the figure. pyplot does not know a new one; a notebook shows it.

        Raises:
            ValueError: for another quantity.

        Example:
            >>> run = tipoff.run(tipoff.load("tiny"), "springs")
            >>> run.plot().axes[0].get_ylabel()
            'rate (deg/s)'
        """
        from tipoff import plots  # slow to load

        if not isinstance(quantity, str) or quantity not in _PLOTTED:
            raise ValueError(f"quantity: given {quantity!r}, expected {' or '.join(_PLOTTED)}")
        unit, factor = _PLOTTED[quantity]
        values = factor * getattr(self, quantity)
        return plots.lines(
            ("time after ignition (ms)", 1e3 * self.time),
            f"{quantity} ({unit})",
            list(zip(VECTOR, values.T)),
            f"{self.scene.get('name', '')}, model {self.model}",
            axes,
        )

    def to_csv(self, path: str | Path) -> None:
        """Write time, position, velocity and rates of the payload, with units in the header,
        atomically. ``tipoff calibrate --reference`` reads this file.

        Args:
            path: file to write.

        Example:
            >>> tipoff.run(tipoff.load("tiny"), "springs").to_csv("run.csv")
            >>> open("run.csv").readline()[:36]
            'time [s],position_x [m],position_y ['
        """
        columns = {"time [s]": self.time}
        for name, unit, factor in (
            ("position", "m", 1.0),
            ("velocity", "m/s", 1.0),
            ("rate", "deg/s", 180.0 / math.pi),
        ):
            values = factor * getattr(self, name)
            columns |= {f"{name}_{axis} [{unit}]": values[:, i] for i, axis in enumerate(VECTOR)}
        write_csv(path, columns)

    @property
    def guides(self) -> tuple[guides.Guide, ...]:
        """What each button, or each pad of a scene without buttons, does: when it leaves the rail, with
        which speed and rates, and its largest force.

        Raises:
            SceneError: a trajectory that was read back, if its scene needs files that are gone.

        Example:
            >>> run = tipoff.run(tipoff.load("tiny"), "springs")
            >>> last = max(run.guides, key=lambda guide: guide.leaves_s)
            >>> last.name, abs(last.leaves_s - run.outcome.exit_time) < 1e-6
            ('pad 1', True)
        """
        from tipoff.scenes.scene import parse

        return guides.of_run(parse(self.scene, bare_numbers_are_si=True), self)

    @property
    def by_hand(self) -> tuple[hand_calculation.ByHand, ...]:
        """The rates by a hand calculation, for comparison, where one is valid: settled by moment impulse over
        inertia, if at most one pad touches; at exit of a rocket on two buttons that turns about the rear one.

        Raises:
            SceneError: a trajectory that was read back, if its scene needs files that are gone.

        Example:
            >>> run = tipoff.run(tipoff.load("tiny"), "springs")
            >>> run.by_hand  # more than one pad touches
            ()
        """
        from tipoff.scenes.scene import parse

        return hand_calculation.of_run(parse(self.scene, bare_numbers_are_si=True), self)

    def state_at_exit(self) -> hand_over.State:
        """State of the payload 0.1 ms after the exit, in the middle of the window at exit.

        Returns:
            hand_over.State: time (s), position (m), velocity (m/s), quaternion and rate (rad/s),
            in the axes of the trajectory.

        Raises:
            SceneError: a run that did not leave the rail and settle.

        Example:
            >>> run = tipoff.run(tipoff.load("tiny"), "springs")
            >>> run.state_at_exit().velocity.shape
            (3,)
        """
        return hand_over.at_exit(self.outcome)

    def export(self, kind: str, path: str | Path) -> None:
        """Write the state at exit for codes of flight, atomically.

        Args:
            kind: ``rocketpy``, JSON with the ``initial_solution`` of RocketPy's ``Flight``; or
                ``csv``, the same 14 numbers as a table.
            path: file to write.

        Raises:
            SceneError: another kind, or a run that did not leave the rail and settle.

        Example:
            >>> tipoff.run(tipoff.load("tiny"), "springs").export("rocketpy", "exit.json")
            >>> import json
            >>> len(json.load(open("exit.json"))["initial_solution"])
            14
        """
        hand_over.write(kind, path, self.scene, self.outcome)

    def to_xarray(self) -> "xarray.Dataset":
        """Labelled copy, with the motion relative to the platform.

        Returns:
            xarray.Dataset: variables over ``time`` (s) with their unit in ``attrs["units"]``.

        Example:
            >>> data = tipoff.run(tipoff.load("tiny"), "springs").to_xarray()
            >>> data.rate.dims, data.rate.attrs["units"]
            (('time', 'axis'), 'rad/s')
        """
        import xarray  # slow to load, and a run that writes no file does not need it

        return xarray.Dataset(variables(self), attrs=attributes(self))

    def save(self, path: str | Path) -> None:
        """Write netCDF with its digest, atomically: an interrupted call leaves the earlier file, or
        none.

        Args:
            path: file to write.

        Raises:
            OSError: a file that cannot be written.

        Example:
            >>> tipoff.run(tipoff.load("tiny"), "springs").save("run.nc")
        """
        write_sealed(path, content(self))

    @classmethod
    def load(cls, path: str | Path) -> "Trajectory":
        """Read what ``save`` wrote.

        Args:
            path: file to read.

        Returns:
            Trajectory: the run.

        Raises:
            FileNotFoundError: no such file.
            OSError: a foreign file, or one that does not fit its digest.

        Example:
            >>> tipoff.run(tipoff.load("tiny"), "springs").save("run.nc")
            >>> tipoff.Trajectory.load("run.nc").status
            'exited'
        """
        import h5py  # xarray takes fifteen times as long for the same bits

        if not Path(path).is_file():
            raise FileNotFoundError(f"{path}: no such trajectory file")
        try:
            require_whole(path)
            with h5py.File(path) as data:
                require_format(path, data.attrs.get(FORMAT_KEY))
                arrays: dict[str, Any] = {
                    name: data[name][()]
                    for name in ("time", *DIMENSIONS)
                    if name in data or name not in OPTIONAL
                }
                plain = {name: json.loads(data.attrs[name]) for name in PLAIN}
                finite.require_plain(plain)
                result = outcome.Outcome(**json.loads(data.attrs["outcome"]))
                return cls(
                    model=data.attrs["model"],
                    status=data.attrs["status"],
                    message=data.attrs["message"],
                    outcome=result,
                    error=ModelError.read(data.attrs.get("error")),
                    **arrays,
                    **plain,
                )
        except DamageError as fault:
            raise OSError(
                f"{path}: not a whole trajectory file: it {fault.reason}; make it again"
            ) from fault
        except Exception as error:  # the type from HDF5 depends on the foreign file
            raise OSError(f"{path}: not a whole trajectory file ({error})") from error
