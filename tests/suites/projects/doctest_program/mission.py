"""Turn a table by quarter turns.

>>> from robot import Table
>>> table = Table()
>>> quarter(table)
90
>>> quarter(table)
180
"""


def quarter(table):
    """One quarter turn.

    >>> from robot import Table
    >>> table = Table()
    >>> quarter(table)
    90
    >>> table.turns
    1
    """
    table.turn(90)
    return table.angle()


def home(table):
    """Back to zero, the brake on.

    >>> from robot import Table
    >>> table = Table()
    >>> home(table)
    >>> table.braked
    True
    """
    table.turn(-table.angle())
    table.brake(True)
