"""A call of an operation on its way: found, understood, mutated, recorded."""
