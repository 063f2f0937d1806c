"""Conventional mutation operators on program text: one file each, ``operator.py`` is the contract."""

from .mutants import Planted as Planted
from .mutants import plant as plant
from .operator import ClassicalOperator as ClassicalOperator
from .operator import Draft as Draft
from .operator import Example as Example
from .refine import merge as merge
from .refine import refine as refine
from .registry import names as names
from .registry import operator as operator
from .texts import find_texts as find_texts
from .texts import program_files as program_files
