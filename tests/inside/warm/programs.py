# ruff: noqa: E501
"""Little programs and ways to start them: each must tell the same of itself, however it began."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

#: says most of what a process can say of itself
WHOLE = """
import json, os, resource, signal, subprocess, sys, threading
first = sorted(sys.modules)
main = sys.modules["__main__"]
def status(*names):
    with open("/proc/self/status") as file:
        return {line.split(":")[0]: line.split()[1] for line in file if line.split(":")[0] in names}
def descriptors():
    found = {}
    for name in sorted(os.listdir("/proc/self/fd"), key=int):
        try:
            found[name] = (os.fstat(int(name)).st_mode, os.get_inheritable(int(name)), os.readlink("/proc/self/fd/" + name).split(":")[0])
        except OSError:
            pass
    return found
def stream(one):
    return [type(one).__name__, one.name, one.mode, one.encoding, one.errors, one.line_buffering, one.write_through,
            type(one.buffer).__name__, one.newlines, one.buffer.fileno(), one.isatty()]
print(json.dumps({
    "argv": sys.argv, "orig_argv": sys.orig_argv, "flags": str(sys.flags), "executable": sys.executable,
    "path": sys.path, "prefix": [sys.prefix, sys.base_prefix, sys.exec_prefix],
    "modules": sorted(name for name in first if name != "__mp_main__"),
    "warnoptions": sys.warnoptions, "xoptions": str(sys._xoptions),
    "main": {name: type(value).__name__ if name.startswith("__l") else str(value)[:200]
             for name, value in vars(main).items() if name not in ("__builtins__", "first", "main")
             and name.startswith("__")},
    "builtins": type(__builtins__).__name__,
    "names": sorted(name for name in vars(main)),
    "frames": sys._getframe().f_back is None,
    "environ": dict(os.environ), "environb": len(os.environb), "cwd": os.getcwd(),
    "sh": subprocess.run("env | sort | grep -v ^_=", shell=True, capture_output=True, text=True).stdout,
    "umask": status("Umask"), "signals": status("SigBlk", "SigIgn", "SigCgt", "Threads"),
    "handlers": [str(signal.getsignal(number)).split(" at ")[0] for number in range(1, 32)],
    "mask": sorted(map(int, signal.pthread_sigmask(signal.SIG_BLOCK, []))),
    "streams": [stream(one) for one in (sys.stdin, sys.stdout, sys.stderr)],
    "same": [sys.stdin is sys.__stdin__, sys.stdout is sys.__stdout__, sys.stderr is sys.__stderr__],
    "descriptors": descriptors(),
    "leads": [os.getpgid(0) == os.getpid(), os.getsid(0) == os.getpid()],
    "alone": [os.getpgid(0) if os.getpgid(0) != os.getpid() else 0, os.getsid(0) if os.getsid(0) != os.getpid() else 0],
    "parent": os.getppid(),
    "limits": [resource.getrlimit(number) for number in range(16)],
    "nice": [os.nice(0), sorted(os.sched_getaffinity(0))],
    "cmdline": open("/proc/self/cmdline").read(), "comm": open("/proc/self/comm").read(),
    "shown": sorted(open("/proc/self/environ").read().split("\\0")),
    "exe": os.readlink("/proc/self/exe"),
    "thread": [threading.main_thread() is threading.current_thread(), threading.active_count()],
    "recursion": sys.getrecursionlimit(), "switch": sys.getswitchinterval(), "hash": hash("robot"),
    "hooks": [sys.excepthook is sys.__excepthook__, sys.displayhook is sys.__displayhook__,
              sys.unraisablehook is sys.__unraisablehook__, str(sys.gettrace()), str(sys.getprofile())],
    "last": [hasattr(sys, name) for name in ("last_type", "last_value", "last_traceback", "ps1")],
    "children": open(f"/proc/self/task/{os.getpid()}/children").read().split().__len__(),
}, sort_keys=True, indent=1))
"""


@dataclass(frozen=True)
class Case:
    """A program and how it is started.

    Attributes:
        name: what it is about.
        files: files to write first, by name, in the folder where it begins.
        command: the command line; ``{python}`` and ``{folder}`` are filled in.
        options: further arguments of ``subprocess.Popen``.
        given: what it reads.
        signal: sent to it as soon as it has said something.
        is_warm: whether it may begin warm.
    """

    name: str
    files: dict[str, str]
    command: tuple[str, ...]
    options: dict[str, Any] = field(default_factory=dict)
    given: str = ""
    signal: int | None = None
    is_warm: bool = True


def script(name: str, text: str, *arguments: str, **options: Any) -> Case:
    """A case of one script."""
    return Case(name, {"it.py": text}, ("{python}", "it.py", *arguments), **options)


CASES = (
    Case("all of a script", {"it.py": WHOLE}, ("{python}", "it.py", "a", "", "b c", "é")),
    Case("all of an absolute script", {"it.py": WHOLE}, ("{python}", "{folder}/it.py")),
    Case("all of a script in a folder", {"sub/it.py": WHOLE}, ("{python}", "./sub/it.py")),
    Case("all of a module", {"it.py": WHOLE}, ("{python}", "-m", "it", "a", "-m")),
    Case("all of a package", {"pack/__init__.py": "x = 1", "pack/__main__.py": WHOLE}, ("{python}", "-m", "pack")),
    Case("all of a command", {}, ("{python}", "-c", WHOLE, "a", "-c")),
    Case("no byte code asked for twice", {"it.py": WHOLE}, ("{python}", "-B", "it.py")),
    Case("a session of its own", {"it.py": WHOLE}, ("{python}", "it.py"), {"start_new_session": True}),
    Case("a group of its own", {"it.py": WHOLE}, ("{python}", "it.py"), {"process_group": 0}),
    Case("a umask", {"it.py": WHOLE}, ("{python}", "it.py"), {"umask": 0o027}),
    Case("signals as they are", {"it.py": WHOLE}, ("{python}", "it.py"), {"restore_signals": False}),
    Case("another folder", {"sub/it.py": WHOLE}, ("{python}", "it.py"), {"cwd": "sub"}),
    Case("open descriptors", {"it.py": WHOLE}, ("{python}", "it.py"), {"close_fds": False}),
    Case("no input", {"it.py": WHOLE}, ("{python}", "it.py"), {"stdin": -3}),
    Case(
        "an environment", {"it.py": WHOLE, "more/extra.py": ""}, ("{python}", "it.py"),
        {"env+": {"PYTHONPATH": "more:{folder}/none", "A": "1=2", "É": "ü", "HOME": "/nowhere"}},
    ),
    Case(
        "a sitecustomize",
        {"it.py": WHOLE, "more/sitecustomize.py": "import sys, json; print(sys.argv, sys.path); sys.mark = 1"},
        ("{python}", "it.py"), {"env+": {"PYTHONPATH": "{folder}/more"}},
    ),
    Case("a wrong sitecustomize", {"it.py": "print(1)", "more/sitecustomize.py": "1 / 0"}, ("{python}", "it.py"),
         {"env+": {"PYTHONPATH": "{folder}/more"}}),
    Case("a console script", {"tool": "#!{python}\n" + WHOLE}, ("{folder}/tool", "x")),
    Case("a script of env", {"tool": "#!/usr/bin/env python\n" + WHOLE}, ("{folder}/tool", "x")),
    script("reads", "import sys\nfor line in sys.stdin: print(line.upper(), end='')", given="a\nb\r\nc"),
    script("writes bytes", "import sys\nsys.stdout.buffer.write(bytes(range(256)))"),
    script("ends", "print('x', end='')"),
    script("exit 3", "import sys\nsys.exit(3)"),
    script("exit text", "import sys\nprint('a')\nsys.exit('no robot')"),
    script("exit none", "raise SystemExit"),
    script("exit large", "raise SystemExit(257)"),
    script("exit object", "raise SystemExit(('a', 1))"),
    script("os exit", "import os\nprint('lost?', flush=True)\nos._exit(7)"),
    script("raises", "def f():\n    1 / 0\nf()"),
    script("raises from", "try:\n    1 / 0\nexcept ZeroDivisionError as e:\n    raise ValueError('x') from e"),
    script("is no program", "x = (\n"),
    script("has an encoding", "# -*- coding: latin-1 -*-\nprint('ok')"),
    script("has a hook", "import sys\nsys.excepthook = lambda *a: print('hook', a[0])\nraise KeyError(1)"),
    script("interrupts itself", "raise KeyboardInterrupt"),
    script("catches an interrupt", "import signal, os\ntry:\n    os.kill(os.getpid(), signal.SIGINT)\n"
           "except KeyboardInterrupt:\n    print('caught')"),
    script("aborts", "import os\nos.abort()"),
    script("kills itself", "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)"),
    script("waits for TERM", "import time\nprint('on\\n', end='', flush=True)\ntime.sleep(20)", signal=15),
    script("waits for INT", "import time\nprint('on\\n', end='', flush=True)\ntime.sleep(20)", signal=2),
    script("handles TERM", "import signal, sys, time\nsignal.signal(15, lambda *a: sys.exit(4))\n"
           "print('on\\n', end='', flush=True)\ntime.sleep(20)", signal=15),
    script("leaves at exit", "import atexit\natexit.register(print, 'bye')\nprint('hello')"),
    script("leaves in order", "import atexit, weakref\nclass A:\n    def __del__(self): print('gone')\na = A()\n"
           "weakref.finalize(a, print, 'final')\natexit.register(print, 'bye')"),
    script("raises at exit", "import atexit\natexit.register(lambda: 1 / 0)"),
    script("a thread goes on", "import threading, time\n"
           "threading.Thread(target=lambda: (time.sleep(0.1), print('late'))).start()\nprint('main')"),
    script("a daemon is left", "import threading, time\n"
           "threading.Thread(target=time.sleep, args=(20,), daemon=True).start()\nprint('main')"),
    script("a thread raises", "import threading\ndef f(): 1 / 0\nt = threading.Thread(target=f)\nt.start()\nt.join()"),
    script("an interrupt and a thread", "import atexit, threading\natexit.register(print, 'bye')\n"
           "threading.Thread(target=print, args=('t',)).start()\nraise KeyboardInterrupt"),
    script("full output", "import sys\nsys.stdout = open('/dev/full', 'w')\nprint('x')"),
    script("closed output", "import os\nprint('x')\nos.close(1)"),
    script("prints its stack", "import traceback\ndef f(): traceback.print_stack()\nf()"),
    Case("prints the stack of a module", {"it.py": "1 / 0"}, ("{python}", "-m", "it")),
    Case("a module of a library", {}, ("{python}", "-m", "calendar", "2024", "2")),
    Case("a package of a library", {}, ("{python}", "-m", "pytest", "--version")),
    Case("a package of a library again", {}, ("{python}", "-m", "pytest", "--version")),
    Case("exits in a module", {"it.py": "import sys\nsys.exit('text')"}, ("{python}", "-m", "it")),
    Case("exits in a module by number", {"it.py": "import sys\nsys.exit(9)"}, ("{python}", "-m", "it")),
    Case("is interrupted in a module", {"it.py": "raise KeyboardInterrupt"}, ("{python}", "-m", "it")),
    Case("no such module", {}, ("{python}", "-m", "no_such_module")),
    Case("an error in a command", {}, ("{python}", "-c", "1 / 0")),
    Case("no command", {}, ("{python}", "-c", "")),
    script("imports what is on the shelf", "import sys\nprint('json' in sys.modules)\nimport json, logging, socket\n"
           "print(json.__spec__, json.decoder.__name__, 'json.decoder' in sys.modules, logging.getLogger())\n"
           "import importlib.util\nprint(importlib.util.find_spec('http.server').origin)\n"
           "import http.server\nprint(http.server.__spec__.loader.__class__, http.client.__file__)"),
    *(
        script(f"a package that means something else by a module's name, {time}", "import sys\n"
               "class Seeing:\n    def find_spec(self, name, *more):\n        seen.append(name)\n"
               "seen = []\nsys.meta_path.insert(0, Seeing())\nimport pytest_bdd, tomllib, mutabot.operators\n"
               "print(pytest_bdd.scenario, pytest_bdd.given, sys.modules['pytest_bdd.scenario'])\n"
               "print([one for one in seen if one.startswith('pytest_bdd')], len(seen) > 50)")
        for time in ("once", "again")
    ),
    script("imports what lies beside it", "import beside\nprint(beside.__file__, __file__)\nprint(beside.x)"),
    Case("has a module of a library's name", {"it.py": "import json\nprint(json.__file__)", "json.py": "x = 1"},
         ("{python}", "it.py"), is_warm=False),
    script("inserts a path", "import os, sys\nos.mkdir('more')\nopen('more/json.py', 'w').write('y = 2')\n"
           "sys.path.insert(0, 'more')\nimport json\nprint(json.y)"),
    script("starts processes", "import subprocess, sys\nprint(subprocess.run([sys.executable, '-c', 'print(5)'],"
           " capture_output=True).stdout)\ntry:\n    import os\n    os.wait()\nexcept ChildProcessError: print('none')"),
    script("spawns", "import multiprocessing as m\ndef f(q, x): q.put((x * 2, __name__, m.current_process().name))\n"
           "if __name__ == '__main__':\n    m.set_start_method('spawn')\n    q = m.Queue()\n"
           "    p = m.Process(target=f, args=(q, 4))\n    p.start()\n    print(q.get())\n    p.join()\n"
           "    print(p.exitcode)"),
    script("has a pool", "import multiprocessing as m\nif __name__ == '__main__':\n    with m.Pool(2) as p:\n"
           "        print(p.map(abs, [-1, -2]))"),
    script("runs asyncio", "import asyncio\nasync def f():\n    p = await asyncio.create_subprocess_exec('echo', 'hi',"
           " stdout=-1)\n    print(await p.communicate())\nasyncio.run(f())"),
    script("draws differently", "import random\nfrom random import random as r\nprint(0 <= r() < 1)"),
    Case("options that are not known", {"it.py": WHOLE}, ("{python}", "-O", "it.py"), is_warm=False),
    Case("isolated", {"it.py": "import sys\nprint(sys.flags)"}, ("{python}", "-I", "it.py"), is_warm=False),
    Case("a folder", {"app/__main__.py": WHOLE}, ("{python}", "app"), is_warm=False),
    Case("no such file", {}, ("{python}", "none.py"), is_warm=False),
    Case("from input", {}, ("{python}",), given="print(3)", is_warm=False),
    Case("another hash", {"it.py": WHOLE}, ("{python}", "it.py"), {"env+": {"PYTHONHASHSEED": "5"}}, is_warm=False),
    Case("another locale", {"it.py": WHOLE}, ("{python}", "it.py"), {"env+": {"LC_ALL": "C"}}, is_warm=False),
    Case("no Python", {}, ("/bin/echo", "hi"), is_warm=False),
)  # fmt: skip
