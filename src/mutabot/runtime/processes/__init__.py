"""Processes below the tests: what makes them part of a campaign, and what they tell.

``startup`` is what every Python process loads, ``member`` a process that turned out to be of interest, and
``members`` the test process's side, which puts together what they tell.
"""
