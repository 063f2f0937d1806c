"""The operators on the text of robot programs."""

from __future__ import annotations

from mutabot.api.faults import Rule

FAMILY, CONVENTIONAL = "program-text", "program-conventional"


class _TextRule(Rule):
    family = FAMILY


class ShiftTarget(_TextRule):
    """One use of a pose is shifted along an axis.

    Where: targets of motions whose pose is written there or named.

    Stands for: A point taught at a wrong place, or an offset with a wrong sign or number.
    """

    name = "shift-target"
    has_sizes = True


class ShiftPoint(_TextRule):
    """A taught pose is shifted along an axis wherever it is used.

    Where: declarations of poses, also in a data file.

    Stands for: A point that was touched up wrongly, or a part that lies elsewhere than when it was taught.
    """

    name = "shift-point"
    has_sizes = True


class ReverseOffset(_TextRule):
    """An offset from a pose goes the other way.

    Where: ``Offs``, ``RelTool``, ``pose_trans`` and the geometric operator, with a number that is not 0.

    Stands for: A sign that is wrong, or an approach along an axis that points the other way.
    """

    name = "reverse-offset"


class TurnTarget(_TextRule):
    """One use of a pose is turned about an axis of its own.

    Where: targets of motions whose pose is written there or named.

    Stands for: A gripper that is turned wrongly, or an angle with a wrong unit.
    """

    name = "turn-target"
    has_sizes = True


class SwapMotion(_TextRule):
    """A straight motion becomes a joint motion, and the other way about.

    Where: motions.

    Stands for: ``MoveL`` and ``MoveJ``, ``LIN`` and ``PTP``, ``movel`` and ``movej`` taken for each other.
    """

    name = "swap-motion"


class DropStatement(_TextRule):
    """A motion, an output, a wait or a setting is missing.

    Where: statements that the robot or its signals take part in.

    Stands for: A line that was deleted, commented out, or skipped by a jump.
    """

    name = "drop-statement"


class InvertOutput(_TextRule):
    """An output gets the opposite value.

    Where: digital outputs.

    Stands for: A gripper that opens where it should close, or an output that is wired the other way about.
    """

    name = "invert-output"


class InvertInput(_TextRule):
    """An input is taken for its opposite.

    Where: conditions and waits that read a digital input.

    Stands for: A sensor that closes where another one opens, or ``NOT`` forgotten.
    """

    name = "invert-input"


class OtherInput(_TextRule):
    """Another input is read.

    Where: inputs that have a number, if the program reads another such one.

    Stands for: A wrong number, or sensors that were swapped.
    """

    name = "other-input"


class ForgetWait(_TextRule):
    """A wait for a signal does not wait.

    Where: waits for inputs.

    Stands for: A wait that was taken out for a trial run.
    """

    name = "forget-wait"


class ScaleWait(_TextRule):
    """A pause is ten times as short or as long.

    Where: pauses with a number.

    Stands for: A wrong unit, or a pause that was made shorter to save time.
    """

    name = "scale-wait"


class ScaleSpeed(_TextRule):
    """A motion is ten times as slow or twice as fast.

    Where: speeds of motions.

    Stands for: Wrong speed data, or a speed in a wrong unit.
    """

    name = "scale-speed"


class OtherTool(_TextRule):
    """A motion is made with another tool.

    Where: tools of motions and settings of the tool.

    Stands for: A tool that was not changed in the program when the gripper was.
    """

    name = "other-tool"


class OtherFrame(_TextRule):
    """A pose is taken in another frame.

    Where: work objects, bases and features.

    Stands for: A base that was not set, or not set back.
    """

    name = "other-frame"


class WrongConfiguration(_TextRule):
    """A pose names another configuration of the arm.

    Where: configuration data of poses.

    Stands for: A pose copied from a place that the arm reaches otherwise.
    """

    name = "wrong-configuration"


class ChangeBlend(_TextRule):
    """A motion rounds its corner that did not, or the other way about.

    Where: zones and blending of motions.

    Stands for: ``fine`` and ``z50`` taken for each other, ``CONT`` lost.
    """

    name = "change-blend"


class ReplaceArithmetic(_TextRule):
    """An arithmetic operator becomes another one (AOR).

    Where: calculations with numbers.
    """

    name = "replace-arithmetic"
    family = CONVENTIONAL


class ReplaceRelation(_TextRule):
    """A comparison becomes another one (ROR).

    Where: comparisons.
    """

    name = "replace-relation"
    family = CONVENTIONAL


class ReplaceLogic(_TextRule):
    """``AND`` becomes ``OR``, and the other way about (COR).

    Where: conditions.
    """

    name = "replace-logic"
    family = CONVENTIONAL


class NegateCondition(_TextRule):
    """A condition is negated (COI).

    Where: branches and loops.
    """

    name = "negate-condition"
    family = CONVENTIONAL


class ReplaceNumber(_TextRule):
    """A number becomes 0, or one more (CRP).

    Where: numbers of calculations, comparisons and assignments.
    """

    name = "replace-number"
    family = CONVENTIONAL


class DropAny(_TextRule):
    """A statement is missing (SDL).

    Where: assignments, calls and jumps.
    """

    name = "drop-any"
    family = CONVENTIONAL


RULES: tuple[Rule, ...] = (
    ShiftTarget(), ShiftPoint(), ReverseOffset(), TurnTarget(), SwapMotion(), DropStatement(),
    InvertOutput(), InvertInput(),
    OtherInput(), ForgetWait(), ScaleWait(), ScaleSpeed(), OtherTool(), OtherFrame(), WrongConfiguration(),
    ChangeBlend(), ReplaceArithmetic(), ReplaceRelation(), ReplaceLogic(), NegateCondition(), ReplaceNumber(),
    DropAny(),
)  # fmt: skip
BY_NAME = {rule.name: rule for rule in RULES}
