"""The folder that comes first in ``PYTHONPATH`` while a campaign runs."""
