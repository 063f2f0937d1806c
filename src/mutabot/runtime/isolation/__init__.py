"""Forked processes that continue a running session: mutants, and copies of a fork server."""
