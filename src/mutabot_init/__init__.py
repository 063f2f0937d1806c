"""Proposing a configuration and a vocabulary for a project, from one plain run of its tests; or a project."""
