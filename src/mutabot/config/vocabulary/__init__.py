"""Vocabularies: the meaning of a robot API, read from TOML and checked."""

from .load import load_vocabulary as load_vocabulary
