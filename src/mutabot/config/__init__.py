"""The configuration and vocabularies, read from TOML files and checked, with messages about mistakes."""
