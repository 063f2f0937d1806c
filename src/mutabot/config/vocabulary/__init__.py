"""Vocabularies: the meaning of a robot API, read from TOML and checked."""

from mutabot.config.mistakes import problem_error as problem_error

from .load import load as load
