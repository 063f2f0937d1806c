"""The visual model of a cell, for pictures; no simulation loads it."""
