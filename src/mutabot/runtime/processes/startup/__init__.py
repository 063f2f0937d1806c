"""The folder that stands first in ``PYTHONPATH`` while a campaign runs."""
