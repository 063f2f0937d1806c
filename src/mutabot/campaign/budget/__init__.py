"""A campaign in limited time: what is run first, in batches that end in time."""
