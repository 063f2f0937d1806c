"""Serves the report of a running campaign to browsers on this machine, with a button to stop."""
