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


class _ConventionalRule(Rule):
    family = CONVENTIONAL


class AbsoluteValue(_ConventionalRule):
    """A number becomes its absolute value, the negative of that, or an error if it is zero (ABS).

    Where: variables, components, calls and calculations whose values are numbers.
    """

    name = "absolute-value"


class ReplaceArithmetic(_ConventionalRule):
    """An arithmetic operator becomes another one, or the calculation one of its operands (AOR).

    Where: calculations with numbers; sums and differences of points and texts too.
    """

    name = "replace-arithmetic"


class ReplaceRelation(_ConventionalRule):
    """A comparison becomes another one, or always holds, or never (ROR).

    Where: comparisons.
    """

    name = "replace-relation"


class ReplaceLogic(_ConventionalRule):
    """A logical operator becomes another one, or the condition one of its operands, true or false (COR).

    Where: conditions.
    """

    name = "replace-logic"


class ReplaceShift(_ConventionalRule):
    """A shift of bits goes the other way (SOR).

    Where: ``BitLSh`` and ``BitRSh``; KRL and URScript have no shift.
    """

    name = "replace-shift"


class ReplaceBitwise(_ConventionalRule):
    """An operator on bits becomes another one, or the operation one of its operands (LOR).

    Where: ``B_AND``, ``B_OR`` and ``B_EXOR``; ``BitAnd``, ``BitOr`` and ``BitXOr``.
    """

    name = "replace-bitwise"


class ReplaceAssignment(_ConventionalRule):
    """A number is counted down instead of up, and the other way about (ASR).

    Where: ``Incr`` and ``Decr``; KRL and URScript have no augmented assignment.
    """

    name = "replace-assignment"


class InsertUnary(_ConventionalRule):
    """A number gets a minus, a condition a logical not (UOI, COI).

    Where: numbers that are not 0, and what has a number or a truth value; conditions of branches and loops.
    """

    name = "insert-unary"


class DeleteUnary(_ConventionalRule):
    """A sign or a logical not is left out (UOD).

    Where: signs and ``NOT``.
    """

    name = "delete-unary"


class ReplaceVariable(_ConventionalRule):
    """A variable becomes another one of its type that the routine names, of at most four (SVR).

    Where: variables that are read, also points, tools and frames.
    """

    name = "replace-variable"


class ReplaceStatement(_ConventionalRule):
    """A statement becomes one that stops the program with an error, a division by zero (BSR).

    Where: assignments, calls and jumps; the conditions of branches and loops.
    """

    name = "replace-statement"


class ReplaceNumber(_ConventionalRule):
    """A number becomes 0, or one more (CRP).

    Where: numbers of calculations, comparisons and assignments.
    """

    name = "replace-number"


class DropAny(_ConventionalRule):
    """A statement is missing (SDL).

    Where: assignments, calls and jumps.
    """

    name = "drop-any"


RULES: tuple[Rule, ...] = tuple(
    kind() for base in (_TextRule, _ConventionalRule) for kind in base.__subclasses__()
)
BY_NAME = {rule.name: rule for rule in RULES}
