"""Proposes a configuration and a vocabulary from one plain run of a project's tests, or starts a project."""
