"""The interface for packages beside the core: they import nothing else of mutabot.

``faults``: providers, operators and what makes a mutant active. ``values``: operations, quantities and calls.
``reports``: results, recordings and commands. ``processes``: where tasks run, and what lives beside the
program. ``mutabot.extensions.INTERFACE`` is the version of all of them.
"""
