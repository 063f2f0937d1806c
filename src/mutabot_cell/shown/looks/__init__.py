"""How a cell looks in pictures: a model of its own, which no simulation ever loads."""
