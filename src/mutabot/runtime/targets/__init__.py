"""How operations are found at run time, by the kind of their targets."""
