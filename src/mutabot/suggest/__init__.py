"""Suggesting checks that kill survivors, proven by running them."""

from mutabot.suggest.suggest import suggest

__all__ = ["suggest"]
