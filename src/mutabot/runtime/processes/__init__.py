"""Make processes below the tests part of a campaign, and collect their events.

``startup`` is what every Python process loads, ``member`` a process that turned out to be of interest, and
``members`` the test process's side, which puts together what they report.
"""

import sys
from typing import Any


class _LateInspect:
    """Stands for ``inspect`` in ``dataclasses``, which hardly needs it before Python 3.12."""

    def __getattr__(self, name: str) -> Any:
        found: Any = sys.modules.get("inspect")
        if found is self:  # the import system asks
            raise AttributeError(name)
        import inspect  # noqa: PLC0415  # this is the point

        return getattr(inspect, name)


if sys.modules.keys().isdisjoint(("dataclasses", "inspect")):  # a process below the tests
    sys.modules["inspect"] = _LateInspect()  # type: ignore[assignment]  # it need not be a module
    import dataclasses  # noqa: F401  # all of ours need it

    del sys.modules["inspect"]
