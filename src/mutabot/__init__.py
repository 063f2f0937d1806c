"""Mutation testing for robot programs."""

__version__ = "0.1.0"
