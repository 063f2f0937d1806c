"""The errors that a work cell can raise.

    CellError
    ├── SimulatorMissing (ImportError)     mujoco or a planner library is not installed
    ├── BadArgument (ValueError)           a value of the wrong type, or not finite, at the border
    ├── BadModel (ValueError)              a file of a robot or tool lacks something, or has a wrong unit
    ├── LimitError                         a motion would exceed a limit
    │   ├── MotionRefused                  target out of reach or limits; nothing has moved
    │   └── PathLost                       the tool could not follow what it tracked; it has braked to rest
    ├── ProtectiveStop                     the arm hit something hard; the motion has ended
    ├── ProgramsStuck                      programs that run together had not ended in time
    ├── SensorError                        nothing to read (no box in the cell)
    ├── ConditionBroken (AssertionError)   an `always` condition was false at some tick
    └── SimulationDiverged                 the physics gave NaN or nonsense: the tool failed, not the robot

Each error carries its data as attributes too, so that reports need not parse messages.
"""

# ruff: noqa: N818  (the names say what happened, as robot controllers do: "motion refused", "protective stop")
from __future__ import annotations

from collections.abc import Mapping, Sequence


class CellError(Exception):
    """Base class of all errors of a work cell."""


class SimulatorMissing(CellError, ImportError):
    """A library of the extra `cells` is not installed."""

    def __init__(self, library: str) -> None:
        super().__init__(f"mutabot_cell needs '{library}': install mutabot with its extra 'cells'")
        self.library = library


class BadArgument(CellError, ValueError):
    """An argument has a wrong type or value."""


class BadModel(CellError, ValueError):
    """A model file of a robot, tool or scene cannot be used; the message says what to add to it."""


class LimitError(CellError):
    """A motion would exceed a limit.

    Attributes:
        limit: what would be exceeded.
        value: the value that the motion would need, in `unit`; None where there is none.
        allowed: the nearest allowed value, in `unit`; None where there is none.
        excess: by how much the limit would be exceeded (>= 0), in `unit`.
        unit: "m", "deg", "m/s" or "deg/s".
        fraction: part of the path that could be travelled, 0..1.
    """

    def __init__(
        self,
        message: str,
        *,
        limit: str,
        value: float | None = None,
        allowed: float | None = None,
        excess: float = 0.0,
        unit: str = "",
        fraction: float = 0.0,
    ) -> None:
        super().__init__(message)
        self.limit = limit
        self.value = value
        self.allowed = allowed
        self.excess = excess
        self.unit = unit
        self.fraction = fraction


class MotionRefused(LimitError):
    """The controller refused a motion before anything moved.

    Its `limit` is "reach", "joint 1" to "joint 7", "singularity" and so on; or "protective stop" when an
    earlier one has not been acknowledged.
    """


class PathLost(LimitError):
    """The motion that the tool followed left the arm's limits; the arm brakes to rest by itself.

    Its `limit` is "reach", "joint 1 speed", "joint 1 angle" and so on.
    """


class ProtectiveStop(CellError):
    """The arm met an unexpected resistance, and stopped.

    Attributes:
        time: simulated time of the stop, s.
        first: name of the touching part on the robot's side; "" when nothing touches.
        second: name of the part it touched; "" when nothing touches.
        force: normal force of the strongest contact, N.
        joint: joint that noticed, 1..7.
        torque: external torque on that joint, Nm; of its motor if it was overloaded.
        following_error: commanded minus actual angle of that joint, rad.
        overload: torque that the joint could give without end, Nm; 0 if it was not overloaded.
    """

    def __init__(
        self,
        *,
        time: float,
        first: str,
        second: str,
        force: float,
        joint: int,
        torque: float,
        following_error: float,
        overload: float = 0.0,
    ) -> None:
        what = f"{first} touched {second} with {force:.0f} N" if first else "resistance without a contact"
        details = f"external torque {torque:.1f} Nm, following error {following_error:.4f} rad"
        if overload:
            what = f"joint {joint} is overloaded"
            details = f"{torque:.1f} Nm, {overload:.0f} Nm is what it can give without end"
        super().__init__(f"protective stop at t={time:.2f} s: {what} (joint {joint}: {details})")
        self.time = time
        self.first = first
        self.second = second
        self.force = force
        self.joint = joint
        self.torque = torque
        self.following_error = following_error
        self.overload = overload


class ProgramsStuck(CellError):
    """Programs that run together did not end in time, as when they wait for each other.

    Attributes:
        time: simulated time at which this was noticed, s.
        names: of the programs that had not ended.
    """

    def __init__(self, *, time: float, names: Sequence[str]) -> None:
        super().__init__(f"programs still wait at t={time:.2f} s: {', '.join(names)}")
        self.time = time
        self.names = tuple(names)


class SensorError(CellError):
    """A sensor has nothing to read."""


class ConditionBroken(CellError, AssertionError):
    """An `always` condition did not hold.

    Attributes:
        name: the condition's name.
        time: simulated time at which it broke, s.
        values: what was measured at that moment, as given by the condition.
    """

    def __init__(self, *, name: str, time: float, values: Mapping[str, object]) -> None:
        shown = ", ".join(
            f"{key}={value:.4g}" if isinstance(value, float) else f"{key}={value}"
            for key, value in values.items()
        )
        super().__init__(f"'{name}' broke at t={time:.2f} s" + (f": {shown}" if shown else ""))
        self.name = name
        self.time = time
        self.values = dict(values)


class SimulationDiverged(CellError):
    """The physics produced NaN or absurd values.

    Attributes:
        time: simulated time at which it was noticed, s.
    """

    def __init__(self, *, time: float, reason: str) -> None:
        super().__init__(f"simulation diverged at t={time:.3f} s: {reason}")
        self.time = time
        self.reason = reason
