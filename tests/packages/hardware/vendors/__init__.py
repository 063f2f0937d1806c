"""Controllers that speak the real protocols, for the vendors' own client libraries."""
