"""``mutabot merge``: the shards of a campaign as one."""
