import json
import tempfile
from pathlib import Path

CALIBRATION = Path(tempfile.gettempdir()) / "corpus_calibration.json"


def calibrate(axis):
    axis.jog(-3.0)
    low = axis.read()
    axis.jog(10.0)
    CALIBRATION.write_text(json.dumps({"low": low, "high": axis.read()}))
    axis.jog(-4.0)


def range_of_motion():
    limits = json.loads(CALIBRATION.read_text())
    return limits["high"] - limits["low"]
