"""Footprints: what a test shares with others, and what it leaves behind when it is over."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SharedFixture:
    """A fixture, set up once, that a test used and others may use as well.

    Attributes:
        name: the fixture's name.
        scope: ``class``, ``module``, ``package`` or ``session``.
        instance: which set-up of it, the same in every test that used this one.
        has_teardown: whether something of the user's runs when it is taken down.
    """

    name: str
    scope: str
    instance: int
    has_teardown: bool = False


@dataclass(frozen=True, slots=True)
class Footprint:
    """What of a test can be noticed outside of it.

    Attributes:
        fixtures: the shared fixtures it used whose value, or whose set-up, another test may depend on.
        left: state of the process that was otherwise after the test than before it, such as
            ``robot.ARM``.
        replaced: those of these names that stand for a new object, made in this test: a robot that every
            test makes for itself.
        unseen: state that nobody can look into, and that the test may have changed.
        files: what it did to files and to other things that a fork would share, in words; those that
            outlive the test first.
        outlives: whether a later test may find something of these.
        exclusive: the first of these that other processes would get in the way of, or None.
        processes: processes below the tests that were there during it, by number, with a name for people.
    """

    fixtures: tuple[SharedFixture, ...] = ()
    left: tuple[str, ...] = ()
    replaced: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    outlives: bool = False
    exclusive: str | None = None
    processes: tuple[tuple[int, str], ...] = ()
