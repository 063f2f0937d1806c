"""Proposing operations that have a name on a middleware, from what was seen to pass under it."""
