"""A motion that was started and continues while time passes."""

from __future__ import annotations

from typing import Protocol


class _Mover(Protocol):
    """The interface of an arm for its moves."""

    def is_under_way(self, move: Move) -> bool: ...

    def finish(self, move: Move) -> None: ...

    def brake(self, move: Move) -> None: ...


class Move:
    """A motion of the arm that does not block: it continues whenever simulated time passes.

        move = cell.arm.start_move_by(y=0.2)
        while not move.done:
            cell.wait(0.01)

    A protective stop on the way is raised by whatever lets time pass; the move is done then.
    """

    def __init__(self, arm: _Mover) -> None:
        self._arm = arm

    @property
    def done(self) -> bool:
        """Whether the motion has ended: arrived, stopped, or ended by a protective stop."""
        return not self._arm.is_under_way(self)

    def wait(self) -> None:
        """Let time pass until the motion has ended and the arm has settled, as the moves that block do.

        Raises:
            ProtectiveStop: something was in the way.
            PathLost: the tool could not follow what it tracks.
        """
        self._arm.finish(self)

    def stop(self) -> None:
        """Brake on the path, and wait until the tool has stopped (on a tracked belt: relative to the belt).

        Does nothing if the motion has ended.

        Raises:
            ProtectiveStop: something was in the way.
        """
        self.brake()
        self.wait()

    def brake(self) -> None:
        """Begin to brake on the path, and return at once. Do nothing if the motion has ended."""
        if not self.done:
            self._arm.brake(self)
