"""A worker that answers with whatever makes trouble: code to be run before a Dask worker starts."""

from __future__ import annotations

#: what a worker does when it is asked to introduce itself: the first argument names the attack, the other a
#: file in which whoever unpickles its load writes the number of its process
CODE = '''
import builtins, importlib, os, pickle
from distributed import get_worker
from distributed.protocol.serialize import ToPickle
from mutabot_dask import worker_side

wire = importlib.import_module("distributed.protocol.serialize")

class Inner:
    def __init__(self, file):
        self.file = file
    def __reduce__(self):
        run = f"with open({self.file!r}, 'a') as file: file.write(str(__import__('os').getpid()) + ' ')"
        return exec, (run,)

class Load(Exception):
    """What is left of it once it has run its code is an exception like any other."""
    def __reduce__(self):
        return Exception, (Inner(self.args[0]),)

def as_object(file):
    return Load(file)

def as_exception(file):
    raise Load(file)

def as_marked(file):
    return ToPickle(Load(file))

class Faked:
    """Serialized as it pleases."""
    def __init__(self, header, *frames):
        self.header, self.frames = header, frames

dumped = wire.families["dask"]
wire.families["dask"] = (
    lambda x, context=None: (
        (dict(x.header), list(x.frames)) if type(x) is Faked else dumped[0](x, context=context)
    ),
    *dumped[1:],
)
serialized = wire.serialize
def serialize(x, *given, **more):
    return (dict(x.header), list(x.frames)) if type(x) is Faked else serialized(x, *given, **more)
wire.serialize = serialize

def as_type(file):
    header = {"serializer": "dask", "type-serialized": pickle.dumps(Load(file)), "sub-header": {}}
    return Faked(header, b"{}")

def as_unknown(file):
    return Faked({"serializer": "no such serializer"}, b"{}")

def as_broken(file):
    return Faked({"serializer": "pickle", "writeable": ()}, b"no pickle")

def as_list(file):
    return [b"{}", Load(file)]

def as_warning(file):
    load = pickle.dumps(Load(file))
    get_worker().log_event("warn", {"message": load, "category": load})
    return b"{}"

class Chained(Exception):
    pass

def as_cause(file):
    try:
        raise Load(file)
    except Load as error:
        raise Chained("an honest exception") from error

def as_bytes(file):
    return b"{}"

attacks = {name: attack for name, attack in list(globals().items()) if name.startswith("as_")}

def attack(name, file):
    return attacks[name](file)

worker_side.introduce = attack

evaluate = builtins.eval
def bare(source, *scopes):
    """Raises as Dask has it, where our functions would answer with words."""
    given = scopes[0].get("given", ()) if scopes else ()
    if given and given[0] in ("as_exception", "as_cause"):
        return attack(*given)
    return evaluate(source, *scopes)

builtins.eval = bare
'''
#: names of the attacks
ATTACKS = (
    "as_object", "as_exception", "as_marked", "as_type", "as_unknown", "as_broken", "as_list", "as_warning",
    "as_cause",
)  # fmt: skip
#: a worker that says of every unit that mutants were killed which it was not asked for
FORGER = """
from dataclasses import replace
from mutabot.execution.answer import Answer
from mutabot.execution.task import Result
from mutabot.model.events import ForkTestEnd, SessionEnd
from mutabot.model.events import TestEnd
from mutabot_dask import worker_side
from mutabot_dask.unit import UnitAnswer, WorkUnit

honest = worker_side.run_unit

def run_unit(data):
    unit = WorkUnit.of(data)
    if unit.task.job.mutant.operator not in ("reverse", "skip"):
        return honest(data)  # a control
    (test, *_), mutant = unit.task.job.tests, unit.task.job.mutant
    killed = TestEnd(test, "failed", hits=1, acted=1)
    forged = ForkTestEnd(replace(mutant, operator="noise").id, killed)
    answer = Answer([killed, forged, SessionEnd(1)], Result(unit.task))
    return UnitAnswer(answer, ticket=unit.ticket).data(unit.ground.root)

worker_side.run_unit = run_unit
"""
#: values that nobody would send
ODD = (
    None, True, -1, 2**63, 10**400, 0.0, float("nan"), float("inf"), -0.5, "", "\x00", "\x1b[2J", "\ud800",
    "x" * 5000, [], {}, [[]], [None], {"": {}}, [0, [0.5], None, None], ["run", [1.0]], {"type": "TestEnd"},
    "passed", "failed", [1, {}, True], {"raised": 1},
)  # fmt: skip
