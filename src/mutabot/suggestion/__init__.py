"""Suggesting checks that kill survivors, proven by running them."""

from mutabot.suggestion.suggest import suggest

__all__ = ["suggest"]
