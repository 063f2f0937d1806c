"""Targets of operations at run time: callables, and names on middlewares."""
