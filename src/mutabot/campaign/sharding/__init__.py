"""Shards: a campaign in parts on machines that know nothing of each other, and one journal of them."""
