"""What notes readings runs in the process of the tests."""

from __future__ import annotations

import subprocess
import sys


def test_what_notes_in_the_process_of_the_tests_loads_the_standard_library_alone() -> None:
    code = (
        "import sys; before = {*sys.modules}; import mutabot_suggest.noted\n"
        "print(*{name.partition('.')[0] for name in {*sys.modules} - before} - sys.stdlib_module_names)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["mutabot_suggest"]
