"""Suggesting checks that kill survivors, proven by running them."""

from .suggest import suggest

__all__ = ["suggest"]
