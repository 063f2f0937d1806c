"""Switch off plug-ins that run tests elsewhere, again or in another order, or measure coverage.

Their options may stand in a project's ``addopts``, their settings in its configuration, their fixtures and
markers in its tests. So something stands in for each: it declares what the plug-in declares, by the plug-in's
own functions, and does nothing. What the options say is forgotten.

Limits of wall clock that the suite brings along: they must mean the same to every engine.
"""

from __future__ import annotations

import contextlib
import faulthandler
import importlib
import re
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import pytest

from mutabot.extensions import packages
from mutabot.frozen import frozen
from mutabot.model.clocks import monotonic
from mutabot.model.events import Watched
from mutabot.runtime.isolation.namespaces import left_out
from mutabot.runtime.seeds import node_id


@frozen
class Plugin:
    """A plug-in to switch off.

    Attributes:
        package: its name as a requirement.
        entries: names under which pytest loads it, with the module behind each.
        markers: markers that it declares.
    """

    package: str
    entries: tuple[tuple[str, str], ...]
    markers: tuple[str, ...] = ()


PLUGINS = (
    Plugin(
        "pytest-xdist", (("xdist", "xdist.plugin"), ("xdist.looponfail", "xdist.looponfail")),
        ("xdist_group(name)",),
    ),
    Plugin("pytest-cov", (("pytest_cov", "pytest_cov.plugin"),), ("no_cover",)),
    Plugin("pytest-rerunfailures", (("rerunfailures", "pytest_rerunfailures"),), ("flaky(reruns)",)),
    Plugin("flaky", (("flaky", "flaky.flaky_pytest_plugin"),), ("flaky",)),
    Plugin("pytest-retry", (("pytest-retry", "pytest_retry.retry_plugin"),), ("flaky(retries)",)),
    Plugin("pytest-randomly", (("randomly", "pytest_randomly"),)),
    Plugin(
        "pytest-random-order", (("random_order", "random_order.plugin"),), ("random_order(disabled=True)",)
    ),
    Plugin("pytest-forked", (("pytest_forked", "pytest_forked"),), ("forked",)),
    Plugin("pytest-parallel", (("parallel", "pytest_parallel"),)),
    Plugin(
        "pytest-run-parallel", (("run-parallel", "pytest_run_parallel.plugin"),),
        ("parallel_threads(n)", "parallel_threads_limit(n)", "force_parallel_threads(n)", "iterations(n)",
         "thread_unsafe"),
    ),
    Plugin("pytest-testmon", (("pytest-testmon", "testmon.pytest_testmon"),)),
)  # fmt: skip
#: hooks by which a plug-in only declares something
_DECLARING = ("pytest_addhooks", "pytest_addoption")
#: where a requirement's name ends
_NAME = re.compile(r"[A-Za-z0-9._-]+")


def switch_off(manager: pytest.PytestPluginManager) -> None:
    """Switch off installed plug-ins of these, before pytest loads them."""
    config: Any = manager.get_plugin("pytestconfig")
    off = _SwitchedOff()
    for plugin in PLUGINS:
        replaced = [_replace(manager, config, off, *entry) for entry in plugin.entries]
        if True in replaced:
            off.plugins.append(plugin)
    # the project's configuration may require them
    packages = {_normal(plugin.package) for plugin in off.plugins}
    required = config.getini("required_plugins")
    required[:] = [text for text in required if _normal(text) not in packages]
    manager.register(off, "mutabot-switches-off")


def _replace(
    manager: pytest.PytestPluginManager, config: Any, off: _SwitchedOff, entry: str, module: str
) -> bool:
    """Block a plug-in and load a stand-in for it. Return whether it is installed."""
    was_named = any(manager.has_plugin(name) for name in (entry, module))  # by ``-p``, before us
    for name in (entry, module):
        manager.set_blocked(name)
    try:
        plugin = importlib.import_module(module)
    except Exception:  # not there, or broken: then pytest could not use it either
        return False
    hooks = () if was_named else _DECLARING  # nothing can be declared twice
    manager.register(_stand_in(plugin, hooks), f"mutabot-stands-in-for-{entry}")
    defaults = vars(config.option)  # nothing else yet
    off.defaults |= {name: defaults[name] for name in _options(plugin) if name in defaults}
    return True


def _options(plugin: ModuleType) -> set[str]:
    """Return the names under which a plug-in's options are stored."""
    parser = _Parser()
    with contextlib.suppress(Exception):  # it asks for more than it has to
        getattr(plugin, "pytest_addoption", lambda parser: None)(parser)
    return parser.options


class _Parser:
    """Stands for pytest's parser and its groups of options, to find out which options there are."""

    def __init__(self) -> None:
        self.options: set[str] = set()

    def getgroup(self, *names: str, **more: Any) -> _Parser:
        return self

    def addoption(self, *names: str, **attributes: Any) -> None:
        own = next((name for name in names if name.startswith("--")), names[0])
        self.options.add(attributes.get("dest") or own.lstrip("-").replace("-", "_"))

    _addoption = addoption

    def addini(self, *names: str, **attributes: Any) -> None:
        pass


def _stand_in(plugin: ModuleType, hooks: tuple[str, ...]) -> ModuleType:
    """Return a plug-in with the markers, options and fixtures of another."""
    found = ModuleType(f"stand-in for {plugin.__name__}")
    for name, value in vars(plugin).items():
        # before pytest 8.4, a fixture is a function with a mark
        is_fixture = hasattr(value, "_pytestfixturefunction")
        if name in hooks or is_fixture or type(value).__name__ == "FixtureFunctionDefinition":
            setattr(found, name, value)
    return found


def _normal(requirement: str) -> str:
    name = _NAME.match(requirement.strip())
    return re.sub(r"[._-]+", "-", name[0]).lower() if name else ""


class _SwitchedOff:
    """Declares the markers and options of plug-ins that are switched off; options have their defaults."""

    def __init__(self) -> None:
        self.plugins: list[Plugin] = []
        self.defaults: dict[str, Any] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_cmdline_main(self, config: pytest.Config) -> None:
        """Restore the defaults of the switched-off plug-ins' options."""
        vars(config.option).update(self.defaults)

    def pytest_configure(self, config: pytest.Config) -> None:
        """Register the markers, so that pytest accepts them."""
        for plugin in self.plugins:
            for marker in plugin.markers:
                config.addinivalue_line("markers", f"{marker}: of {plugin.package}, without effect here")


def keep_real_files() -> None:
    """Keep pyfakefs, where it is loaded, from putting a fake file system in the place of ours."""
    fakes: Any = sys.modules.get("pyfakefs.fake_filesystem_unittest")
    if fakes is not None:
        ours = packages()
        fakes.Patcher.SKIPMODULES.update(
            module for name, module in sys.modules.copy().items() if name.partition(".")[0] in ours
        )


@contextmanager
def timers_held() -> Iterator[None]:
    """Stop the process's timers inside the context, and let a process forked in it have the rest.

    A fork inherits none; and a parent that waits for its forks has not used that time itself.
    """
    timers = (signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF)
    held = [(timer, *signal.setitimer(timer, 0.0)) for timer in timers]
    try:
        yield
    finally:
        for timer, left, interval in held:
            if left:
                signal.setitimer(timer, left, interval)


def watched(test: str, seconds: float, by: str) -> Watched:
    """Return the limit at which ``by`` ends this process with exit code 1 unless ``test`` has ended.

    Args:
        test: node id.
        seconds: of wall clock, from now on.
        by: what sets the limit: the name of the plug-in or option.
    """
    until = monotonic() + left_out() + seconds
    return Watched(test, until, f"no end after {seconds:g} s of wall clock ({by})")


def watched_by_faulthandler(item: pytest.Item) -> Watched | None:
    """Return the limit of pytest's faulthandler; None if there is none, or it only prints."""
    seconds, ends = _faulthandler(item.config)
    return watched(node_id(item), seconds, "faulthandler_timeout") if seconds > 0 and ends else None


def drop_idle_watchdog(item: pytest.Item) -> None:
    """End the thread of a faulthandler that only prints, as it would prevent forks."""
    seconds, ends = _faulthandler(item.config)
    if seconds > 0 and not ends:
        faulthandler.cancel_dump_traceback_later()


def _faulthandler(config: pytest.Config) -> tuple[float, bool]:
    try:
        seconds = float(config.getini("faulthandler_timeout") or 0.0)
    except (ValueError, KeyError):  # pytest's plug-in is switched off
        return 0.0, False
    try:
        return seconds, bool(config.getini("faulthandler_exit_on_timeout"))
    except (ValueError, KeyError):  # an older pytest only prints
        return seconds, False
