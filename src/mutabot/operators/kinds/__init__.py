"""The operators on calls: a file for each kind of fault."""
