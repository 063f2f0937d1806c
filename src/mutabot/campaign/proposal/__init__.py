"""Proposing a configuration and a vocabulary for a project, by reading its text and never importing it."""

from .propose import propose as propose
