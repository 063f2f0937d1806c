"""Run jobs in processes, a limited number at a time."""
