"""Plain data: what mutabot talks about, without any input or output."""

from .call import Call as Call
from .call import Proceed as Proceed
from .call import Reply as Reply
from .codec import from_data as from_data
from .codec import to_data as to_data
from .job import Budget as Budget
from .job import Job as Job
from .job import Problem as Problem
from .job import SessionEnd as SessionEnd
from .job import SiteSeen as SiteSeen
from .job import TestEnd as TestEnd
from .mutant import Mutant as Mutant
from .operation import Clock as Clock
from .operation import Operation as Operation
from .operation import Pattern as Pattern
from .operation import Probe as Probe
from .operation import Vocabulary as Vocabulary
from .path import Path as Path
from .quantity import Kind as Kind
from .quantity import Mode as Mode
from .quantity import Quantity as Quantity
from .site import Role as Role
from .site import Site as Site
from .site import Span as Span
from .verdict import By as By
from .verdict import Verdict as Verdict
