"""Proposing a configuration and a vocabulary for a project, from one plain run of its tests."""

from .propose import propose as propose
