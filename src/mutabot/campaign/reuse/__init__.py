"""Reuse of outcomes of earlier campaigns, by the content of what they depend on."""
