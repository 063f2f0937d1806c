"""KRL: programs of KUKA robots, ``.src`` with its ``.dat``, and ``$config.dat``."""
