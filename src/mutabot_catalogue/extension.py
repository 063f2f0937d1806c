"""The extension by which mutabot finds this package's two families of operators on calls."""

from __future__ import annotations

from mutabot.api.faults import Extension

#: module, name and class of each, in the order of the documentation and of the numbers of their mutants
_OPERATORS = """
    amounts   cm-for-m            CentimetreForMetre
    amounts   mm-for-m            MillimetreForMetre
    amounts   inch-for-mm         InchForMillimetre
    amounts   deg-for-rad         DegreeForRadian
    amounts   ms-for-s            MillisecondForSecond
    frames    axis-swap           AxisSwap
    frames    joint-order         JointOrder
    frames    left-handed         LeftHanded
    frames    base-for-tool       BaseForTool
    frames    tcp-missing         TcpMissing
    frames    tcp-doubled         TcpDoubled
    frames    joint-turn          JointTurn
    frames    euler-order         EulerOrder
    frames    quaternion-order    QuaternionOrder
    frames    quaternion-sign     QuaternionSign
    commands  swap-next           SwapNext
    commands  previous-target     PreviousTarget
    commands  half-wait           HalfWait
    commands  no-wait             NoWait
    commands  lost-command        LostCommand
    commands  double-command      DoubleCommand
    commands  late-grip           LateGrip
    commands  early-release       EarlyRelease
    commands  unreported-refusal  UnreportedRefusal
    readings  dropout             Dropout
    readings  old-reading         OldReading
    readings  stuck-reading       StuckReading
    readings  spike               Spike
    readings  saturated-reading   SaturatedReading
    readings  swapped-channels    SwappedChannels
    readings  wrong-object        WrongObject
    readings  confused-label      ConfusedLabel
    readings  late-reading        LateReading
    amounts   speed-override      SpeedOverride
    amounts   force-override      ForceOverride
    amounts   weak-grip           WeakGrip
    amounts   wrong-payload       WrongPayload
    amounts   partial-opening     PartialOpening
    amounts   silent-limit        SilentLimit
    flags     stuck-flag          StuckFlag
    messages  drop                Drop
    messages  duplicate           Duplicate
    messages  stale               Stale
    messages  delay               Delay
    messages  reorder             Reorder
    settings  wrong-frame         WrongFrame
    settings  shift-stamp         ShiftStamp
    settings  empty-stamp         EmptyStamp
    settings  wrong-name          WrongName
    settings  short-queue         ShortQueue
    settings  flip-latch          FlipLatch
    settings  wrong-reliability   WrongReliability
    settings  wrong-durability    WrongDurability
    settings  wrong-deadline      WrongDeadline
    settings  wrong-period        WrongPeriod
    settings  use-default         UseDefault
    messages  kill-node           KillNode
    messages  restart-node        RestartNode
    messages  cancel-goal         CancelGoal
    messages  lose-answer         LoseAnswer
    messages  jump-clock          JumpClock
"""

EXTENSION = Extension(
    interface=2,
    operators={
        name: f"{__package__}.{module}:{kind}"
        for module, name, kind in map(str.split, _OPERATORS.strip().splitlines())
    },
)
