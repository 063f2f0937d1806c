"""Suggested checks: for people, and as data."""
