"""Mutation operators: a file for each kind of fault, ``operator.py`` is the contract."""

from .operator import Example as Example
from .operator import Need as Need
from .operator import Operator as Operator
from .operator import Subject as Subject
from .registry import load_all as load_all
from .registry import names as names
from .registry import operator as operator
