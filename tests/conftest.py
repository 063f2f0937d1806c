"""What all tests need."""

from __future__ import annotations

import compileall
import gc
import os
import signal
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.forked_processes import Interpreter, forked_processes
from tests.processor_time import ProcessorTime


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--processor-time", action="store_true", help="tell what each file of tests takes")


def pytest_configure(config: pytest.Config) -> None:
    """Tests interrupt campaigns: a shell that starts us in the background has had interruptions ignored.

    Tests start a thousand processes that may not write bytecode: it is there before them.
    """
    if not hasattr(config, "workerinput"):
        compileall.compile_dir(Path(__file__).parents[1] / "src", quiet=2)
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    config.pluginmanager.register(ProcessorTime(config))
    config.pluginmanager.register(Bytecode())
    _allow_slow_machines()


def _allow_slow_machines() -> None:
    """No test of a property fails because the machine is busy."""
    # pytest rewrites hypothesis, and keeps that only where bytecode is written
    from hypothesis import HealthCheck, settings  # noqa: PLC0415

    settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
    settings.load_profile("busy")


class Bytecode:
    """What pytest makes of our files is kept until they change, whatever the environment says."""

    def __init__(self) -> None:
        self._is_unwanted, sys.dont_write_bytecode = sys.dont_write_bytecode, False

    def pytest_collection_finish(self) -> None:
        sys.dont_write_bytecode = self._is_unwanted


def pytest_collection_finish() -> None:
    """Thousands of tests and all that they import stay: the collector, called by many, passes them over."""
    gc.collect()
    gc.freeze()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that need a package beside the core skip themselves where it is not installed."""
    for item in items:
        for marker in item.iter_markers("needs"):
            missing = [name for name in marker.args if find_spec(f"mutabot_{name}") is None]
            if missing:
                item.add_marker(pytest.mark.skip(reason=f"needs mutabot_{missing[0]}"))


@pytest.fixture(scope="session", autouse=True)
def bare() -> None:
    """Campaigns load no plug-in that is only there for our own tests: it takes longer than most tests."""
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"


@pytest.fixture(scope="session", autouse=True)
def interpreter(bare: None, request: pytest.FixtureRequest) -> Iterator[Interpreter | None]:
    """In the short run campaigns import pytest once for a thousand of their processes; else as for a user."""
    if request.config.option.markexpr != "not whole":
        yield None
        return
    with forked_processes() as interpreter:
        yield interpreter


@pytest.fixture(scope="module")
def forks(interpreter: Interpreter | None) -> Iterator[None]:
    """Processes of campaigns are forks in the long run as well: how they begin is not what is shown."""
    if interpreter is not None:
        yield
        return
    with forked_processes():
        yield


@pytest.fixture
def plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Campaigns load all plug-ins that are installed, as they do for a user."""
    monkeypatch.delenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", raising=False)


@pytest.fixture
def common() -> Iterator[Path]:
    """A folder that no run keeps to itself: what one writes there, all others see."""
    with TemporaryDirectory(dir="/var/tmp", ignore_cleanup_errors=True) as folder:
        yield Path(folder)
