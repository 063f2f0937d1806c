"""Stored campaigns: what a journal holds as one object, as a table, and beside an older one."""
