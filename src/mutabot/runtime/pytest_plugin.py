"""The pytest plug-in, which is inactive without a job, and always offers seeds to tests and fixtures."""

from __future__ import annotations

import os
import sys
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

import pytest


def _import_mutabot_unrewritten() -> None:
    """Keep pytest from rewriting mutabot's own modules when they are imported.

    It would rewrite the asserts of everything in a plugin's distribution, and parse each module anew in
    every process, as none may write bytecode beside the sources.
    """
    for finder in sys.meta_path:
        marked: Any = getattr(finder, "_must_rewrite", None)
        if isinstance(marked, set):
            marked.difference_update([name for name in marked if name.partition("_")[0] == "mutabot"])
            getattr(finder, "_marked_for_rewrite_cache", {}).clear()


_import_mutabot_unrewritten()  # before anything else of us is imported

from mutabot.model import call  # noqa: E402
from mutabot.model.job import JOB_VARIABLE, PIPE_VARIABLE  # noqa: E402
from mutabot.runtime import seeds  # noqa: E402
from mutabot.runtime.seeds import node_id  # noqa: E402

if TYPE_CHECKING:
    from mutabot.runtime.session_hooks import SessionHooks

_NAME = "mutabot_seed"
#: the fixtures that stand for it, by scope of who asks
_SHARED = {
    "class": "_mutabot_class_seed",
    "module": "_mutabot_module_seed",
    "package": "_mutabot_package_seed",
    "session": "mutabot_round_seed",
}
#: pytest has no public way to say this; where it is not there, ``mutabot_round_seed`` still works
_ASK = "_get_active_fixturedef"
_hooks: SessionHooks | None = None
_plain_round: PlainRound | None = None


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    """Block plug-ins that a job cannot run with, before pytest loads them."""
    if JOB_VARIABLE not in os.environ:
        return
    if pluginmanager.is_blocked("cacheprovider"):
        # else pytest warns of what workers are given
        parser.addini("cache_dir", "where workers would keep what they keep between runs")
    from mutabot.runtime.plugins import switch_off  # noqa: PLC0415  # a sleeping plugin costs nothing

    switch_off(pluginmanager)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> Generator[None, Any, Any]:
    """Prepare the job, if there is one, before any of the user's code is imported."""
    global _hooks, _plain_round  # noqa: PLW0603  # pytest knows this module, not an object of ours
    if JOB_VARIABLE in os.environ and _hooks is None:
        # tests that start pytest themselves must not find the job again
        job, pipe = os.environ.pop(JOB_VARIABLE), os.environ.pop(PIPE_VARIABLE)
        from mutabot.runtime.session_hooks import SessionHooks  # noqa: PLC0415  # a sleeping plugin costs nothing

        _hooks = SessionHooks.from_files(job, int(pipe))
        _hooks.config = early_config
    elif _hooks is None and os.environ.get(call.ROUND_VARIABLE):
        _plain_round = PlainRound.from_environment()
    try:
        return (yield)
    except BaseException as error:
        if (hooks := _hooks_of(early_config)) is not None:
            hooks.import_failed(getattr(error, "cause", error), "")
        raise


def _hooks_of(config: pytest.Config) -> SessionHooks | None:
    """Return the hooks of the job; None for a session that a test has started in this process."""
    return _hooks if _hooks is not None and _hooks.config is config else None


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> Generator[None, Any, Any]:
    """Leave at the end of the session like the interpreter, but without dismantling every module.

    In a fork that would copy all memory that it shares, which took longer than most tests.
    """
    status = yield
    is_last = config.hook.pytest_cmdline_main.get_hookimpls()[-1].plugin is sys.modules[__name__]
    if _hooks_of(config) is not None and is_last and isinstance(status, int):
        from mutabot.runtime.isolation.namespaces import leave  # noqa: PLC0415  # a sleeping plugin costs nothing

        leave(int(status))
    return status


def pytest_configure(config: pytest.Config) -> None:
    """Register the hooks of the job."""
    _offer_at_every_scope(__name__)
    if (hooks := _hooks_of(config)) is not None:
        config.pluginmanager.register(hooks, "mutabot-session")
        config.pluginmanager.register(hooks.tests, "mutabot-tests")
    if _plain_round is not None:
        config.pluginmanager.register(_plain_round, "mutabot-round")


def seed_of(node: pytest.Item | pytest.Collector) -> int:
    """Return the seed of a test, or of a class, module, package or session, in this round.

    It is a whole number of 32 bits; outside a campaign that of ``mutabot_seed``.
    """
    seeded = _seeded(node.config)
    if seeded is not None:
        return seeded.seed_of(node_id(node))
    return int(os.environ.get(call.SEED_VARIABLE, "0"))


def _seeded(config: pytest.Config) -> SessionHooks | PlainRound | None:
    """Return the source of a session's seeds; None for a session that a test has started."""
    return _hooks_of(config) if _hooks is not None else _plain_round


def _seed(request: pytest.FixtureRequest) -> int:
    return seed_of(request.node)


@pytest.fixture
def mutabot_seed(request: pytest.FixtureRequest) -> int:
    """Return the seed of this test in this round: a whole number of 32 bits.

    A fixture that several tests share may ask for it as well, and gets the seed of the class, module, package
    or session that it lives as long as.

    Outside a campaign it is the environment variable MUTABOT_SEED, default 0, or the test's own in the
    round that MUTABOT_ROUND names.
    """
    return _seed(request)


@pytest.fixture(scope="session")
def mutabot_round_seed(request: pytest.FixtureRequest) -> int:
    """Return the seed of this round, the same for all its tests: a whole number of 32 bits."""
    return _seed(request)


# what stands for ``mutabot_seed`` where a shared fixture asks for it
_mutabot_package_seed = pytest.fixture(scope="package", name=_SHARED["package"])(_seed)
_mutabot_module_seed = pytest.fixture(scope="module", name=_SHARED["module"])(_seed)
_mutabot_class_seed = pytest.fixture(scope="class", name=_SHARED["class"])(_seed)


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: Any, request: Any) -> Generator[None, Any, Any]:
    """Seed shared fixtures with seeds of their own."""
    seeded = _seeded(request.config)
    if seeded is None or fixturedef.scope == "function":
        return (yield)
    with seeds.seeded_separately(seeded.seed_of(f"{fixturedef.baseid}::{fixturedef.argname}")):
        return (yield)


def _offer_at_every_scope(owner: str) -> None:
    """Offer the seed to fixtures of every scope; ``owner`` defines it, and others may override it.

    To pytest a fixture has one scope, and one that is made anew for each test cannot be had by a fixture that
    several tests share. A shared simulator needs a seed as well. So what a shared fixture gets by this name
    is another fixture, of its own scope: the seed of the class, module, package or session that it lives as
    long as.
    """
    ask: Any = getattr(pytest.FixtureRequest, _ASK, None)
    if ask is None or hasattr(ask, "offers_seed"):
        return

    def asked(self: Any, argname: str) -> Any:
        if argname == _NAME and self.scope in _SHARED and _is_defined_by(owner, self):
            argname = _SHARED[self.scope]
        return ask(self, argname)

    asked.offers_seed = True  # type: ignore[attr-defined]  # a mark on it: several sessions may share a process
    setattr(pytest.FixtureRequest, _ASK, asked)


def _is_defined_by(owner: str, request: Any) -> bool:
    definitions = request._fixturemanager.getfixturedefs(_NAME, request._pyfuncitem)
    return bool(definitions) and getattr(definitions[-1].func, "__module__", None) == owner


class PlainRound:
    """Pytest's hooks for a round outside of a campaign: plain pytest draws exactly the seeds of that round.

    ``MUTABOT_ROUND=3 pytest tests/test_place.py::test_it`` fails again where a campaign says that the test
    fails in round 3. ``MUTABOT_CAMPAIGN_SEED`` is the campaign's seed, 1 if it is not set.

    Args:
        seed: the campaign's seed.
        round: 0-based round.
    """

    def __init__(self, seed: int, round: int) -> None:
        self._seed, self._round = seed, round
        seeds.seed_all(seeds.derive(seed, "import"))

    @classmethod
    def from_environment(cls) -> PlainRound | None:
        """Return the round in the environment, or None. Raises pytest.UsageError for an invalid one."""
        number = _whole_number(call.ROUND_VARIABLE, least=1)
        if number is None:
            return None
        if os.environ.get(call.SEED_VARIABLE):
            names = call.ROUND_VARIABLE, call.SEED_VARIABLE
            text = "{} gives every test its seed in that round, {} another one; set one of the two"
            raise pytest.UsageError(text.format(*names))
        seed = _whole_number(call.CAMPAIGN_SEED_VARIABLE, least=0)
        return cls(call.DEFAULT_SEED if seed is None else seed, number - 1)

    def seed_of(self, name: str) -> int:
        """Return the seed of a test or shared fixture in this round."""
        return seeds.derive(self._seed, self._round, name)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtestloop(self) -> Generator[None, Any, Any]:
        """Seed the generators after all tests are collected."""
        seeds.seed_all(self.seed_of("session"))
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Run one test with its fixtures."""
        seeds.seed_all(self.seed_of(node_id(item)))
        return (yield)


def _whole_number(variable: str, *, least: int) -> int | None:
    text = os.environ.get(variable, "").strip()
    if not text:
        return None
    if not text.isdecimal() or int(text) < least:
        raise pytest.UsageError(f"{variable} is {text!r}; it takes a whole number from {least} on")
    return int(text)
