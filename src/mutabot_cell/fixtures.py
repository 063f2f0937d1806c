"""Pytest fixtures for a test suite, and the hook that fails a test whose broken condition was swallowed.

# conftest.py
from mutabot_cell.fixtures import *  # noqa: F403

def test_mission(new_cell):
    cell = new_cell(seed=3)     # inside, time.sleep is simulated
    cell.always(lambda: cell.truth.box_position().z > 0.7, "the box never falls to the floor")
    mission.run()
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack

import pytest

from .cell import Cell, current, forget_current
from .clock import simulated_time

__all__ = ["new_cell", "pytest_runtest_call"]


@pytest.fixture
def new_cell() -> Iterator[Callable[..., Cell]]:
    """Return a function that makes cells (arguments as for `Cell`) and simulates `time.sleep` from then."""
    with ExitStack() as stack:

        def make(*args: object, **options: object) -> Cell:
            cell = Cell(*args, **options)  # type: ignore[arg-type]  # passed on as they are
            stack.enter_context(simulated_time(cell))
            return cell

        yield make
    forget_current()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Fail the test at its end if a condition broke and the program swallowed the exception."""
    result = yield
    cell = current()
    if cell is not None:
        cell.verify()
    return result
