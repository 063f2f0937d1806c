"""Plain data: what mutabot talks about, without any input or output."""

from mutabot.model.values.path import Path as Path
from mutabot.model.values.quantity import Kind as Kind
from mutabot.model.values.quantity import Mode as Mode
from mutabot.model.values.quantity import Quantity as Quantity

from .alternative import FATAL as FATAL
from .alternative import IDENTITY as IDENTITY
from .alternative import Alternative as Alternative
from .alternative import Choice as Choice
from .alternative import Instrumentation as Instrumentation
from .alternative import ProgramText as ProgramText
from .alternative import Sighting as Sighting
from .alternative import TextPlace as TextPlace
from .call import Call as Call
from .call import Middleware as Middleware
from .call import Mishap as Mishap
from .call import NotToldError as NotToldError
from .call import Proceed as Proceed
from .call import Reply as Reply
from .mutant import Mutant as Mutant
from .operation import Case as Case
from .operation import Clock as Clock
from .operation import Operation as Operation
from .operation import Pattern as Pattern
from .operation import Probe as Probe
from .operation import Vocabulary as Vocabulary
from .outcome import Compared as Compared
from .outcome import Kill as Kill
from .outcome import LeftOut as LeftOut
from .outcome import Outcome as Outcome
from .site import Role as Role
from .site import Site as Site
from .site import Span as Span
from .verdict import By as By
from .verdict import Verdict as Verdict
