"""What this package brings to mutabot: two families of operators on calls.

Their order is that of the documentation, and of the numbers of their mutants.
"""

from __future__ import annotations

from mutabot.extensions import INTERFACE, Extension

#: the operators of each module, by their names
_OPERATORS: tuple[tuple[str, dict[str, str]], ...] = (
    (
        "amounts",
        {
            "cm-for-m": "CentimetreForMetre",
            "mm-for-m": "MillimetreForMetre",
            "inch-for-mm": "InchForMillimetre",
            "deg-for-rad": "DegreeForRadian",
            "ms-for-s": "MillisecondForSecond",
        },
    ),
    (
        "frames",
        {
            "axis-swap": "AxisSwap",
            "joint-order": "JointOrder",
            "left-handed": "LeftHanded",
            "base-for-tool": "BaseForTool",
            "tcp-missing": "TcpMissing",
            "tcp-doubled": "TcpDoubled",
            "joint-turn": "JointTurn",
            "euler-order": "EulerOrder",
            "quaternion-order": "QuaternionOrder",
            "quaternion-sign": "QuaternionSign",
        },
    ),
    (
        "commands",
        {
            "swap-next": "SwapNext",
            "previous-target": "PreviousTarget",
            "half-wait": "HalfWait",
            "no-wait": "NoWait",
            "lost-command": "LostCommand",
            "double-command": "DoubleCommand",
            "late-grip": "LateGrip",
            "early-release": "EarlyRelease",
            "unreported-refusal": "UnreportedRefusal",
        },
    ),
    (
        "readings",
        {
            "dropout": "Dropout",
            "old-reading": "OldReading",
            "stuck-reading": "StuckReading",
            "spike": "Spike",
            "saturated-reading": "SaturatedReading",
            "swapped-channels": "SwappedChannels",
            "wrong-object": "WrongObject",
            "confused-label": "ConfusedLabel",
            "late-reading": "LateReading",
        },
    ),
    (
        "amounts",
        {
            "speed-override": "SpeedOverride",
            "force-override": "ForceOverride",
            "weak-grip": "WeakGrip",
            "wrong-payload": "WrongPayload",
            "partial-opening": "PartialOpening",
            "silent-limit": "SilentLimit",
        },
    ),
    (
        "messages",
        {
            "drop": "Drop",
            "duplicate": "Duplicate",
            "stale": "Stale",
            "delay": "Delay",
            "reorder": "Reorder",
        },
    ),
    (
        "settings",
        {
            "wrong-frame": "WrongFrame",
            "shift-stamp": "ShiftStamp",
            "empty-stamp": "EmptyStamp",
            "wrong-name": "WrongName",
            "short-queue": "ShortQueue",
            "flip-latch": "FlipLatch",
            "wrong-reliability": "WrongReliability",
            "wrong-durability": "WrongDurability",
            "wrong-deadline": "WrongDeadline",
            "wrong-period": "WrongPeriod",
            "use-default": "UseDefault",
        },
    ),
    (
        "messages",
        {
            "kill-node": "KillNode",
            "restart-node": "RestartNode",
            "cancel-goal": "CancelGoal",
            "lose-answer": "LoseAnswer",
            "jump-clock": "JumpClock",
        },
    ),
)

EXTENSION = Extension(
    interface=INTERFACE,
    operators={
        name: f"mutabot_catalogue.{module}:{kind}"
        for module, operators in _OPERATORS
        for name, kind in operators.items()
    },
)
