"""Shards: parts of a campaign on independent machines, and the merging of their journals."""
