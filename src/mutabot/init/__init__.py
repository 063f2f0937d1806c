"""Proposing a configuration and a vocabulary for a project, from one plain run of its tests; or a project."""

from .propose import propose as propose
from .template import start as start
