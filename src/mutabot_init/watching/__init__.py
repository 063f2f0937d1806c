"""Observes one plain run of the suite, for ``mutabot init``."""
