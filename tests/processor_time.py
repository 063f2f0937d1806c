"""The processor time of tests and of all processes that they start: a busy machine does not change it."""

from __future__ import annotations

import resource
import time
from collections import Counter
from collections.abc import Iterator

import pytest

_NAME = "processor seconds"


def used() -> float:
    """Processor seconds of this process and of all below it that have ended."""
    below = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + below.ru_utime + below.ru_stime


class ProcessorTime:
    """Tells at the end of a run what it took, and with ``--processor-time`` what each file took."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._before = 0.0
        self._files: Counter[str] = Counter()

    def pytest_runtest_logstart(self) -> None:
        self._before = used()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, call: pytest.CallInfo[None]) -> Iterator[None] | pytest.TestReport:  # type: ignore[misc]
        report: pytest.TestReport = yield
        if call.when == "teardown":
            report.user_properties.append((_NAME, used() - self._before))
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            self._files[report.nodeid.partition("::")[0]] += dict(report.user_properties)[_NAME]

    @pytest.hookimpl(trylast=True)
    def pytest_unconfigure(self) -> None:
        """Only now have those ended among whom the tests were divided."""
        if hasattr(self._config, "workerinput"):
            return
        if self._config.getoption("--processor-time"):
            for file, seconds in self._files.most_common():
                print(f"{seconds:8.1f} s  {file}")
        print(f"processor time: {used() / 60:.1f} min")
