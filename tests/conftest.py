"""What all tests need."""

from __future__ import annotations

import os
import signal

import pytest

from tests.processor_time import ProcessorTime


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--processor-time", action="store_true", help="tell what each file of tests takes")


def pytest_configure(config: pytest.Config) -> None:
    """Tests interrupt campaigns: a shell that starts us in the background has had interruptions ignored."""
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    config.pluginmanager.register(ProcessorTime(config))


@pytest.fixture(scope="session", autouse=True)
def bare() -> None:
    """Campaigns load no plug-in that is only there for our own tests: it takes longer than most tests."""
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"


@pytest.fixture
def plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Campaigns load all plug-ins that are installed, as they do for a user."""
    monkeypatch.delenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", raising=False)
