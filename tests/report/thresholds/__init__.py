"""Tests of reports of thresholds."""
