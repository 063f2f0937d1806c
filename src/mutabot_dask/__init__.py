"""Campaigns over Dask: this machine plans, judges and writes; workers elsewhere only run units.

A unit is one task. The controller gives each worker one at a time, and knows from that whose loss is whose.
"""
