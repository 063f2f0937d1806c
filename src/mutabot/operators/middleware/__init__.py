"""The operators of the family ``middleware``: what befalls messages, nodes and what they are set up with."""
