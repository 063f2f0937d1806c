"""Wrong configurations and vocabularies: each is refused with the place, the reason and what would do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.config.configuration import load_configuration
from mutabot.config.mistakes import problem_error
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import ConfigurationError, UnknownNameError, VocabularyError
from mutabot.model.events import Problem

MOVE = 'call = "robot:Arm.move"\n'
GOOD_OPERATION = "[[operation]]\n" + MOVE

#: name -> (text of robot.toml, words the message must contain)
VOCABULARIES: dict[str, tuple[str, list[str]]] = {
    "broken_toml": ("[[operation]]\ncall = \n", ["robot.toml:2", "not valid TOML"]),
    "unclosed_list": ("refusals = [", ["robot.toml:1", "not valid TOML"]),
    "inline_table_over_lines": (
        GOOD_OPERATION + "arguments.dx = {\n  kind = 'translation' }",
        ["robot.toml:3", "on one line"],
    ),
    "empty_file": ("", ["robot.toml", "describes nothing", "[[operation]]"]),
    "comments_alone": ("# to do\n", ["robot.toml", "describes nothing", "[[operation]]"]),
    "unknown_top_key": ("[[operations]]\n" + MOVE, ["robot.toml:1", "'operations'", "'operation'"]),
    "single_brackets": ("[operation]\n" + MOVE, ["robot.toml:1", "[[operation]]", "double brackets"]),
    "unknown_operation_key": (GOOD_OPERATION + "comand = true", ["robot.toml:3", "'comand'", "'command'"]),
    "missing_call": ("[[operation]]\ncommand = true", ["robot.toml:1", "operation#1", "'call'", "missing"]),
    "no_colon": ('[[operation]]\ncall = "robot.Arm.move"', ["robot.toml:2", "no colon", "'robot.Arm.move'"]),
    "no_colon_nor_dot": (
        '[[operation]]\ncall = "move"',
        ["robot.toml:2", "no colon", "module:qualified.name"],
    ),
    "two_colons": ('[[operation]]\ncall = "a:b:c"', ["robot.toml:2", "'b:c' is not a Python name"]),
    "no_identifier": ('[[operation]]\ncall = "robot:Arm.2x"', ["robot.toml:2", "'2x' is not a Python name"]),
    "keyword": ('[[operation]]\ncall = "robot:Arm.import"', ["'import' is not a Python name"]),
    "call_with_brackets": ('[[operation]]\ncall = "robot:move()"', ["'move()' is not a Python name"]),
    "nothing_after_colon": ('[[operation]]\ncall = "robot:"', ["a name is missing"]),
    "dot_too_many": ('[[operation]]\ncall = "robot:Arm..move"', ["a name is missing"]),
    "builtin_refusal": (
        GOOD_OPERATION + 'refusals = ["ValueError"]',
        ["robot.toml:3", "'ValueError'", "no colon"],
    ),
    "refusals_as_text": (
        GOOD_OPERATION + 'refusals = "robot:Refused"',
        ["expected a list", 'refusals = ["robot:Refused"]'],
    ),
    "command_as_text": (
        GOOD_OPERATION + 'command = "yes"',
        ["robot.toml:3", "expected true or false", "'yes'"],
    ),
    "call_as_number": ("[[operation]]\ncall = 3", ["robot.toml:2", "call", "expected text", "number 3"]),
    "operation_as_number": ("operation = [3]", ["robot.toml:1", "expected a table", "number 3"]),
    "idle_as_date": (
        GOOD_OPERATION + "idle = 2024-01-01",
        ["robot.toml:3", "idle", "must be a text", "date"],
    ),
    "idle_deep_inside": (GOOD_OPERATION + "idle = { a = [07:30:00] }", ["idle.a", "time 07:30:00"]),
    "idle_without_colon": (GOOD_OPERATION + 'idle = { call = "home" }', ["idle.call", "no colon"]),
    "idle_call_as_number": (GOOD_OPERATION + "idle = { call = 3 }", ["idle.call", "text", "number 3"]),
    "says_nothing": (GOOD_OPERATION + "command = false", ["robot.toml:1", "says nothing"]),
    "same_call_twice": (
        GOOD_OPERATION + GOOD_OPERATION + 'refusals = ["a:B"]',
        ["robot.toml:4", "described twice", "robot.toml:1"],
    ),
    "current_unknown": (
        GOOD_OPERATION
        + "arguments.dx = { kind = 'translation', unit = 'm', mode = 'by' }\ncurrent = 'robot:Arm.moev'",
        ["robot.toml:4", "current", "unknown operation", "'robot:Arm.move'"],
    ),
    "current_reads_another_axis": (
        GOOD_OPERATION
        + "arguments.dx = { kind = 'translation', axis = 'x', unit = 'm', mode = 'by' }\n"
        + "current = 'robot:Arm.pose'\n[[operation]]\ncall = 'robot:Arm.pose'\n"
        + "result = { kind = 'position', axis = 'y', unit = 'm' }",
        ["robot.toml:4", "reads position y", "position x"],
    ),
    "current_in_another_frame": (
        GOOD_OPERATION
        + "arguments.dx = { kind = 'translation', axis = 'x', unit = 'm', mode = 'by', frame = 'tool' }\n"
        + "current = 'robot:Arm.pose'\n[[operation]]\ncall = 'robot:Arm.pose'\n"
        + "result = { kind = 'position', axis = 'x', unit = 'm', frame = 'base' }",
        ["robot.toml:4", "frame 'base'", "frame 'tool'"],
    ),
    "current_is_a_command": (
        GOOD_OPERATION
        + "arguments.dx = { kind = 'translation', unit = 'm', mode = 'by' }\ncurrent = 'robot:Arm.home'\n"
        + "[[operation]]\ncall = 'robot:Arm.home'",
        ["robot.toml:4", "robot:Arm.home is a command"],
    ),
    "current_of_no_use": (
        GOOD_OPERATION
        + "current = 'robot:Arm.pose'\n[[operation]]\ncall = 'robot:Arm.pose'\n"
        + "result = { kind = 'position', unit = 'm' }",
        ["robot.toml:3", "no argument is a translation"],
    ),
    "opposite_unknown": (
        "[[operation]]\ncall = 'g:Hand.open'\nopposite = 'g:Hand.close'\n"
        + "[[operation]]\ncall = 'g:Hand.closed'",
        ["robot.toml:3", "opposite", "'g:Hand.closed'"],
    ),
    "opposite_of_itself": (
        GOOD_OPERATION + "opposite = 'robot:Arm.move'",
        ["robot.toml:3", "its own opposite"],
    ),
    "opposite_with_other_arguments": (
        "[[operation]]\ncall = 'g:open'\nopposite = 'g:close'\n[[operation]]\ncall = 'g:close'\n"
        + "arguments.force = { kind = 'output', range = [0, 9] }",
        ["robot.toml:3", "only g:close has 'force'"],
    ),
    "argument_in_self": (
        GOOD_OPERATION + "arguments.self.speed = { kind = 'duration', unit = 's' }",
        ["robot.toml:3", "arguments.self.speed", "not an argument", "Name an argument"],
    ),
    "argument_self": (
        GOOD_OPERATION + "arguments.self = { kind = 'duration', unit = 's' }",
        ["robot.toml:3", "not an argument"],
    ),
    "overrides_of_a_function": (
        "[[operation]]\ncall = 'robot:move'\noverrides = true",
        ["robot.toml:3", "not a method of a class"],
    ),
    "argument_of_a_pattern_that_holds_the_text": (
        GOOD_OPERATION
        + "message = 'm'\npatterns = [{ text = 'go', arguments.m = { kind = 'duration', unit = 's' } }]",
        ["holds the text command"],
    ),
    "message_in_self_of_a_function": (
        "[[operation]]\ncall = 'link:send'\nmessage = 'self'",
        ["robot.toml:3", "not a method of a class", "no self"],
    ),
    "field_of_a_message_in_self": (
        GOOD_OPERATION
        + "message = 'self'\npatterns = [{ text = 'x{n:d}', kind = 'output', range = [0, 9] }]",
        ["robot.toml:4", "patterns", "comes from self", "{n} cannot be sent"],
    ),
    "opposite_of_a_message_in_self": (
        GOOD_OPERATION + "message = 'self.id'\npatterns = [{ text = 'on', opposite = 'off' }]",
        ["robot.toml:4", "comes from self.id", "an opposite cannot be sent"],
    ),
    "message_that_is_no_path": (
        GOOD_OPERATION + "message = 'self..id'\npatterns = [{ text = 'on' }]",
        ["robot.toml:3", "'self..id' is not the name"],
    ),
    "signature_without_the_deciding_argument": (
        GOOD_OPERATION
        + "signature = '(dx, rel)'\narguments.dx = { kind = 'rotation', unit = 'deg', "
        + "mode = { argument = 'relative', true = 'by', false = 'to' } }",
        ["unknown argument 'relative'", "'rel'"],
    ),
    "two_modes_that_disagree": (
        GOOD_OPERATION
        + "arguments.a = { kind = 'rotation', unit = 'deg', mode = { argument = 'r', 1 = 'by', 2 = 'to' } }\n"
        + "arguments.b = { kind = 'rotation', unit = 'deg', mode = { argument = 'r', 1 = 'by', 3 = 'to' } }",
        ["robot.toml:4", "arguments.b", "r has the values 1, 3 here, but 1, 2"],
    ),
    "signature_without_brackets": (
        GOOD_OPERATION + "signature = 'x, y'",
        ["robot.toml:3", "signature", "bracket", "(body, joints"],
    ),
    "signature_with_a_name_twice": (
        GOOD_OPERATION + "signature = '(x, x)'",
        ["robot.toml:3", "duplicate parameter name: 'x'"],
    ),
    "signature_without_the_argument": (
        GOOD_OPERATION + "signature = '(body, joint)'\narguments.joints = { kind = 'duration', unit = 's' }",
        ["robot.toml:4", "unknown argument 'joints'", "'joint'"],
    ),
    "signature_without_the_message": (
        GOOD_OPERATION + "signature = '(text)'\nmessage = 'texts'",
        ["robot.toml:4", "message", "'texts'", "'text'"],
    ),
    "wait_with_a_length": (
        GOOD_OPERATION + "[wait]\ncall = 'sim:wait'\nunit = 'mm'",
        ["robot.toml:5", "wait.unit", "did you mean 'ms'"],
    ),
    "wait_that_is_no_target": (
        GOOD_OPERATION + "[wait]\ncall = 'wait'",
        ["robot.toml:4", "wait.call", "'wait'"],
    ),
    "clock_with_a_length": (
        GOOD_OPERATION + "[clock]\ntick = 'sim:step'\nunit = 'mm'",
        ["robot.toml:5", "clock.unit", "did you mean 'ms'"],
    ),
    "clock_that_is_read_and_counted": (
        GOOD_OPERATION + "[clock]\ntick = 'sim:step'\ntime = 'self.t'\nstep = 0.01",
        ["robot.toml:6", "clock.step", "not both"],
    ),
    "clock_that_stands_still": (
        GOOD_OPERATION + "[clock]\ntick = 'sim:step'\nstep = 0",
        ["robot.toml:5", "clock.step", "more than 0"],
    ),
    "clock_with_a_bad_path": (
        GOOD_OPERATION + "[clock]\ntick = 'sim:step'\ntime = 'self..t'",
        ["robot.toml:5", "clock.time", "'..t'"],
    ),
    "probe_with_negative_tolerance": (
        "[[probe]]\ncall = 'world:box'\ntolerance = -1.0",
        ["robot.toml:3", "at least 0"],
    ),
}

_BY = "kind = 'translation', axis = 'x', unit = 'm', mode = 'by'"
#: name -> (a quantity's path and table, the key that is named, words the message must contain)
QUANTITIES: dict[str, tuple[str, list[str]]] = {
    "unknown_kind": ("arguments.dx = { kind = 'tranlation' }", ["arguments.dx.kind", "'translation'"]),
    "kind_by_another_name": ("result = { kind = 'colour', values = ['r'] }", ["result.kind", "'label'"]),
    "kind_as_number": ("result = { kind = 3 }", ["result.kind", "expected text", "number 3"]),
    "no_kind": ("arguments.dx = { unit = 'm' }", ["arguments.dx", "'kind'", "missing"]),
    "misspelt_key": ("result = { knd = 'label', values = [1, 2] }", ["'knd'", "'kind'"]),
    "no_table": ("arguments.dx = 'translation'", ["arguments.dx", "expected a table", "'translation'"]),
    "falling_ladder": ("arguments.dx = { " + _BY + ", ladder = [5, 2] }", ["dx.ladder", "must rise", "5, 2"]),
    "ladder_that_begins_at_nothing": (
        "arguments.dx = { " + _BY + ", ladder = [0, 1] }",
        ["dx.ladder", "more than 0", "both directions"],
    ),
    "ladder_of_one_magnitude": (
        "arguments.dx = { " + _BY + ", ladder = [1] }",
        ["dx.ladder", "at least 2"],
    ),
    "ladder_in_an_unknown_unit": (
        "arguments.dx = { " + _BY + ", ladder = { steps = [1, 2], unit = 'mmm' } }",
        ["dx.ladder", "'mmm'", "'mm'"],
    ),
    "ladder_in_another_dimension": (
        "arguments.dx = { " + _BY + ", ladder = { steps = [1, 2], unit = 'deg' } }",
        ["dx.ladder", "'deg' measures no fault of a translation", "mm", "ms"],
    ),
    "ladder_of_a_label": (
        "result = { kind = 'label', values = ['a', 'b'], ladder = [1, 2] }",
        ["result.ladder", "a label has no magnitudes"],
    ),
    "missing_command": (
        "arguments.dx = { " + _BY + ", missing = 'nan' }",
        ["dx.missing", "sent is never missing"],
    ),
    "missing_in_another_way": (
        "result = { kind = 'distance', unit = 'm', missing = 'empty' }",
        ["result.missing", "'empty'", "module:Name"],
    ),
    "tool_in_front_of_a_relative_move": (
        "arguments.dx = { " + _BY + ", tcp = 0.1 }",
        ["dx.tcp", "target position"],
    ),
    "unknown_unit": ("arguments.dx = { " + _BY.replace("'m'", "'mmm'") + " }", ["'mmm'", "'mm'"]),
    "unit_written_out": ("arguments.dx = { " + _BY.replace("'m'", "'metres'") + " }", ["dx.unit", "'m'"]),
    "unit_of_another_dimension": (
        "arguments.dx = { " + _BY.replace("'m'", "'deg'") + " }",
        ["'deg' is not a unit for a translation", "m, cm, mm, um or inch"],
    ),
    "no_unit": (
        "result = { kind = 'angle', axis = 'j1' }",
        ["result.unit", "an angle needs a unit", "rad or deg"],
    ),
    "unit_of_a_label": (
        "result = { kind = 'label', values = ['a', 'b'], unit = 'm' }",
        ["a label has no unit"],
    ),
    "opening_in_metres_without_unit": (
        "arguments.w = { kind = 'opening', range = [0, 85] }",
        ["needs a unit"],
    ),
    "unknown_axis": (
        "arguments.dx = { " + _BY.replace("'x'", "'q'") + " }",
        ["dx.axis", "j1 … j12, x, y, z"],
    ),
    "axis_by_another_name": ("arguments.dx = { " + _BY.replace("'x'", "'yaw'") + " }", ["'yaw'", "'z'"]),
    "joint_13": ("result = { kind = 'angle', axis = 'j13', unit = 'rad' }", ["'j13'", "did you mean 'j"]),
    "axis_of_a_flag": ("result = { kind = 'flag', axis = 'x' }", ["a flag has no axis"]),
    "several_axes_without_slice": ("arguments.to = { " + _BY.replace("'x'", "'xyz'") + " }", ["to[0:3]"]),
    "too_few_axes": (
        "result.'[0:3]' = { kind = 'position', axis = 'xy', unit = 'm' }",
        ["[0:3]", "for each of the 2 axes"],
    ),
    "slice_over_both_ends": (
        "result.'[0:-1]' = { kind = 'position', axis = 'xy', unit = 'm' }",
        ["[0:-1]", "same end"],
    ),
    "slice_in_the_middle": (
        "result.'[0:3].x' = { kind = 'position', unit = 'm' }",
        ["only be the last step"],
    ),
    "slice_of_labels": (
        "result.'[0:3]' = { kind = 'label', values = ['a', 'b'] }",
        ["index instead of a slice"],
    ),
    "described_twice": (
        "result.'[0]' = { kind = 'flag' }\nresult.'[0:2]' = { kind = 'position', axis = 'xy', unit = 'm' }",
        ["robot.toml:4", "[0] is described twice"],
    ),
    "no_mode": ("arguments.dx = { kind = 'translation', unit = 'm' }", ["arguments.dx.mode", '"by"', '"to"']),
    "unknown_mode": ("arguments.dx = { " + _BY.replace("'by'", "'relative'") + " }", ["'relative'", "'by'"]),
    "mode_of_a_reading": (
        "result = { kind = 'position', unit = 'm', mode = 'to' }",
        ["a position has no mode"],
    ),
    "reading_as_argument": (
        "arguments.x = { kind = 'position', unit = 'm' }",
        ["arguments.x.kind", "belongs to result"],
    ),
    "mode_without_an_argument": (
        "arguments.dx = { kind = 'rotation', unit = 'deg', mode = { true = 'by', false = 'to' } }",
        ["dx.mode", "needs the argument that decides", 'argument = "relative"'],
    ),
    "mode_with_one_value": (
        "arguments.dx = { kind = 'rotation', unit = 'deg', mode = { argument = 'r', true = 'by' } }",
        ["dx.mode", "needs a mode for each value of r"],
    ),
    "mode_with_a_wrong_value": (
        "arguments.a = { kind = 'rotation', unit = 'deg', "
        "mode = { argument = 'r', 1 = 'relative', 2 = 'to' } }",
        ["a.mode", "unknown mode 'relative'", "did you mean 'by'"],
    ),
    "mode_with_a_table": (
        "arguments.dx = { kind = 'rotation', unit = 'deg', mode = { argument = 'r', 1 = {}, 2 = 'to' } }",
        ["dx.mode", 'expected "by" or "to"'],
    ),
    "mode_with_a_bad_path": (
        "arguments.dx = { kind = 'rotation', unit = 'deg', mode = { argument = '.r', 1 = 'by', 2 = 'to' } }",
        ["dx.mode.argument", "begin with an argument's name"],
    ),
    "mode_that_the_object_decides": (
        "arguments.d = { kind = 'rotation', unit = 'deg', mode = { argument = 'self', 1 = 'by', 2 = 'to' } }",
        ["d.mode.argument", "not one argument of the call"],
    ),
    "decided_mode_of_an_output": (
        "arguments.o = { kind = 'output', range = [0, 1], mode = { argument = 'r', 1 = 'by', 2 = 'to' } }",
        ["o.mode", "an output has no mode"],
    ),
    "label_as_argument": ("arguments.c = { kind = 'label', values = ['a', 'b'] }", ["belongs to result"]),
    "command_as_result": ("result = { " + _BY + " }", ["belongs to arguments"]),
    "label_without_values": ("result = { kind = 'label' }", ["a label needs values"]),
    "label_with_one_value": ("result = { kind = 'label', values = ['red'] }", ["at least two"]),
    "label_with_equal_values": (
        "result = { kind = 'label', values = ['a', 'a'] }",
        ["'a' occurs twice"],
    ),
    "label_with_list_values": ("result = { kind = 'label', values = [['a'], ['b']] }", ["not a list"]),
    "output_without_values": ("arguments.on = { kind = 'output' }", ["an output needs values", "range"]),
    "text_as_distance": (
        "result = { kind = 'distance', unit = 'm', values = ['a', 'b'] }",
        ["must be numbers"],
    ),
    "falling_range": (
        "arguments.dx = { " + _BY + ", range = [2, 1] }",
        ["dx.range", "must rise", "[2.0, 1.0]"],
    ),
    "clip_of_a_reading": (
        "result = { kind = 'distance', unit = 'm', clip = [0, 1] }",
        ["result.clip", "a distance is read, not sent"],
    ),
    "falling_clip": ("arguments.dx = { " + _BY + ", clip = [2, 1] }", ["dx.clip", "must rise", "[2.0, 1.0]"]),
    "clip_of_three": ("arguments.dx = { " + _BY + ", clip = [1, 2, 3] }", ["clip", "at most 2", "got 3"]),
    "clip_and_values": (
        "arguments.o = { kind = 'output', values = [1, 9], clip = [0, 5] }",
        ["o.clip", "values are all that can be sent"],
    ),
    "quaternion_without_order": (
        "result = { kind = 'quaternion' }",
        ["result.order", 'a quaternion needs order = "wxyz" or "xyzw"'],
    ),
    "order_of_no_quaternion": (
        "result = { kind = 'quaternion', order = 'wzyx' }",
        ["robot.toml:3", "result.order", '"wxyz" or "xyzw"'],
    ),
    "euler_without_order": (
        "result = { kind = 'euler', unit = 'deg' }",
        ["result.order", "three axes in the order of the angles"],
    ),
    "euler_about_the_same_axis_twice": (
        "result = { kind = 'euler', unit = 'deg', order = 'xxy' }",
        ["result.order", '"ZYX"'],
    ),
    "order_of_a_rotation_vector": (
        "result = { kind = 'rotation_vector', unit = 'rad', order = 'xyz' }",
        ["result.order", "a rotation_vector has no order"],
    ),
    "rotation_vector_without_unit": (
        "result = { kind = 'rotation_vector' }",
        ["result", "needs a unit", "rad or deg"],
    ),
    "quaternion_with_unit": (
        "result = { kind = 'quaternion', order = 'wxyz', unit = 'rad' }",
        ["result.unit", "a quaternion has no unit"],
    ),
    "rotation_vector_with_axes": (
        "result.'[3:6]' = { kind = 'rotation_vector', unit = 'rad', axis = 'xyz' }",
        ["axis", "a rotation_vector has no axis"],
    ),
    "range_of_a_rotation_vector": (
        "arguments.o = { kind = 'rotation_vector', unit = 'rad', range = [-1, 1] }",
        ["o.range", "mean something only together"],
    ),
    "range_of_three": ("arguments.dx = { " + _BY + ", range = [1, 2, 3] }", ["range", "at most 2", "got 3"]),
    "infinite_range": ("arguments.dx = { " + _BY + ", range = [0, inf] }", ["finite number"]),
    "value_outside_range": (
        "arguments.o = { kind = 'output', values = [1, 9], range = [0, 5] }",
        ["9 lies outside"],
    ),
    "noise_of_zero": ("result = { kind = 'distance', unit = 'm', noise = 0 }", ["noise", "more than 0"]),
    "noise_of_a_command": ("arguments.dx = { " + _BY + ", noise = 0.1 }", ["a translation has no noise"]),
    "noise_as_text": (
        "result = { kind = 'distance', unit = 'm', noise = '1mm' }",
        ["expected a number", "'1mm'"],
    ),
    "unquoted_result_path": (
        "result.pose.x = { kind = 'position', unit = 'm' }",
        ['result.".pose.x"', "begins"],
    ),
    "bad_path": ("result.'[gap]' = { kind = 'position', unit = 'm' }", ["[gap]", "a key needs quotes"]),
    "path_without_argument": ("arguments.'[0]' = { " + _BY + " }", ["must begin with an argument's name"]),
}

#: name -> (an entry of patterns, words the message must contain)
PATTERNS: dict[str, tuple[str, list[str]]] = {
    "unknown_field": (
        "{ text = 'go/{angle:g}', arguments = { angel = { kind = 'duration', unit = 's' } } }",
        ["unknown field 'angel'", "'angle'"],
    ),
    "two_fields_one_quantity": (
        "{ text = 'go/{a:g}/{b:g}', kind = 'duration', unit = 's' }",
        ["{a} and {b}", "arguments.NAME"],
    ),
    "no_field": (
        "{ text = 'go', kind = 'duration', unit = 's' }",
        ["'go' has no field", "arguments.NAME"],
    ),
    "quantity_twice": (
        "{ text = 'go/{a:g}', kind = 'duration', unit = 's', arguments = { a = {} } }",
        ["describe each, arguments.NAME"],
    ),
    "number_in_a_text_field": ("{ text = 'go/{a}', kind = 'duration', unit = 's' }", ["takes text", "{a:g}"]),
    "text_in_a_number_field": (
        "{ text = 'grip/{a:g}', kind = 'output', values = ['on', 'off'] }",
        ["takes numbers", "'on'", "write {a}"],
    ),
    "broken_braces": ("{ text = 'go/{a' }", ["patterns 'go/{a'", "text"]),
    "unnamed_field": ("{ text = 'go/{}' }", ["plain name"]),
    "bad_format": ("{ text = 'go/{a:yd}' }", ["is not a format"]),
    "empty_text": ("{ text = '' }", ["cannot be empty"]),
    "no_text": ("{ kind = 'flag' }", ["patterns#1", "'text'", "missing"]),
    "opposite_with_other_fields": (
        "{ text = 'up/{a:g}', kind = 'duration', unit = 's', opposite = 'down/{b:g}' }",
        ["opposite", "the same fields", "{a} is in 'up/{a:g}'"],
    ),
    "own_opposite": ("{ text = 'up', opposite = 'up' }", ["its own opposite"]),
    "broken_opposite": ("{ text = 'up', opposite = 'down/{' }", ["opposite", "robot.toml:5"]),
    "same_pattern_twice": ("{ text = 'go/{a:g}' }, { text = 'go/{b:f}' }", ["same commands as 'go/{a:g}'"]),
    "unknown_pattern_key": ("{ txt = 'up' }", ["'txt'", "'text'"]),
    "pattern_as_text": ("'up'", ["expected a table", "'up'"]),
}

#: name -> (text of pyproject.toml below [tool.mutabot], words the message must contain)
GOOD = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
CONFIGURATIONS: dict[str, tuple[str, list[str]]] = {
    "unknown_key": (GOOD + "round = 3", ["pyproject.toml:4", "tool.mutabot.round", "'rounds'"]),
    "no_program": ('vocabulary = ["robot.toml"]', ["pyproject.toml:1", "'program'", "missing"]),
    "no_vocabulary": ('program = ["mission.py"]', ["pyproject.toml:1", "'vocabulary'", "missing"]),
    "empty_program": ('program = []\nvocabulary = ["robot.toml"]', [":2", "program", "must not be empty"]),
    "empty_vocabulary": ('program = ["mission.py"]\nvocabulary = []', [":3", "vocabulary", "empty"]),
    "program_as_text": (
        'program = "mission.py"\nvocabulary = ["robot.toml"]',
        [":2", "expected a list", 'program = ["mission.py"]'],
    ),
    "program_of_numbers": (
        "program = [1]\nvocabulary = ['robot.toml']",
        [":2", "program#1", "expected text"],
    ),
    "no_such_program": (GOOD.replace("mission.py", "misson.py"), [":2", "'misson.py'", "'mission.py'"]),
    "no_such_nested_program": (GOOD.replace("mission.py", "src/cel.py"), ["'src/cel.py'", "'src/cell.py'"]),
    "no_such_folder_at_all": (GOOD.replace("mission.py", "a/b/c.py"), ["there is no 'a/b/c.py'"]),
    "glob_without_match": (GOOD.replace("mission.py", "lib/*.py"), ["'lib/*.py' matches no Python file"]),
    "glob_of_texts": (GOOD.replace("mission.py", "*.toml"), ["no Python file"]),
    "odd_glob": (GOOD.replace("mission.py", "a**"), ["not a pattern of paths"]),
    "absolute_program": (GOOD.replace("mission.py", "/etc"), ["'/etc'", "relative to the project's folder"]),
    "home_program": (GOOD.replace("mission.py", "~/mission.py"), ["relative to the project's folder"]),
    "escape": (GOOD.replace("mission.py", "../mission.py"), [":2", "leads out of the project's folder"]),
    "escape_by_link": (GOOD.replace("mission.py", "outside.py"), ["leads out of the project's folder"]),
    "vocabulary_outside": (GOOD.replace("robot.toml", "../robot.toml"), [":3", "leads out"]),
    "empty_path": (GOOD.replace("mission.py", ""), [":2", "empty path"]),
    "no_such_oracle": (GOOD + 'oracle = ["tests/sensor.py"]', [":4", "'tests/sensors.py'"]),
    "overlap": (GOOD + 'oracle = ["mission.py"]', [":4", "oracle", "overlaps program"]),
    "overlap_by_folder": (
        GOOD.replace("mission.py", ".") + 'oracle = ["tests/sensors.py"]',
        [":4", "oracle", "overlaps program ('.')"],
    ),
    "no_such_tests": (GOOD + 'tests = ["test"]', [":4", "tests#1", "'tests'"]),
    "no_such_test_file": (GOOD + 'tests = ["tests/test_b.py::test_x"]', [":4", "'tests/test_a.py'"]),
    "rounds_zero": (GOOD + "rounds = 0", [":4", "tool.mutabot.rounds", "at least 1", "number 0"]),
    "rounds_as_text": (GOOD + 'rounds = "5"', [":4", "expected a whole number", "'5'"]),
    "rounds_as_fraction": (GOOD + "rounds = 1.5", [":4", "expected a whole number", "1.5"]),
    "rounds_as_flag": (GOOD + "rounds = true", [":4", "expected a whole number", "true"]),
    "negative_seed": (GOOD + "seed = -1", [":4", "at least 0"]),
    "no_jobs": (GOOD + "jobs = 0", [":4", "at least 1"]),
    "short_factor": (GOOD + "timeout_factor = 1", [":4", "more than 1"]),
    "infinite_factor": (GOOD + "timeout_factor = inf", [":4", "finite"]),
    "no_time": (GOOD + "timeout_seconds = 0", [":4", "more than 0"]),
    "memory_without_unit": (GOOD + "memory = 4", [":4", "memory", "'4 GB'"]),
    "memory_in_words": (GOOD + 'memory = "much"', [":4", "'much'", "'4 GB'"]),
    "memory_with_braces": (GOOD + 'memory = "{4} GB"', [":4", "'{4} GB'"]),
    "error_limit_in_percent": (GOOD + "error_limit = 25", [":4", "error_limit", "at most 1"]),
    "limit_in_percent": (GOOD + "unstable_limit = 10", [":4", "at most 1"]),
    "score_over_100": (GOOD + "min_score = 101", [":4", "at most 100"]),
    "date": (GOOD + "seed = 1979-05-27", [":4", "whole number", "date 1979-05-27"]),
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A small project, to which the configuration is missing."""
    folder = tmp_path / "project"
    for name in ("mission.py", "src/cell.py", "tests/sensors.py", "tests/test_a.py"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("")
    (tmp_path / "outside.py").write_text("")
    (folder / "outside.py").symlink_to(tmp_path / "outside.py")
    return folder


def refused(action: Any, *arguments: Any) -> str:
    with pytest.raises(ConfigurationError) as caught:
        action(*arguments)
    assert caught.value.exit_code == 2
    assert caught.value.__cause__ is None
    message = str(caught.value)
    assert "pydantic" not in message
    assert "Input should" not in message
    return message


def vocabulary_refused(folder: Path, text: str) -> str:
    (folder / "robot.toml").write_text(text)
    return refused(load_vocabulary, ["robot.toml"], folder)


@pytest.mark.parametrize("name", VOCABULARIES)
def test_a_wrong_vocabulary_is_refused_with_place_and_remedy(name: str, tmp_path: Path) -> None:
    text, words = VOCABULARIES[name]
    message = vocabulary_refused(tmp_path, text)
    assert [word for word in words if word not in message] == [], message


@pytest.mark.parametrize("name", QUANTITIES)
def test_a_wrong_quantity_is_refused_with_place_and_remedy(name: str, tmp_path: Path) -> None:
    text, words = QUANTITIES[name]
    message = vocabulary_refused(tmp_path, GOOD_OPERATION + text)
    assert message.startswith(("robot.toml:3 · robot:Arm.move · ", "robot.toml:4 · robot:Arm.move · "))
    assert [word for word in words if word not in message] == [], message
    assert len(message.splitlines()) == 1


@pytest.mark.parametrize("name", PATTERNS)
def test_a_wrong_text_command_is_refused_with_place_and_remedy(name: str, tmp_path: Path) -> None:
    text, words = PATTERNS[name]
    lines = f'[[operation]]\ncall = "link:send"\nmessage = "text"\npatterns = [\n  {text},\n]'
    message = vocabulary_refused(tmp_path, lines)
    assert message.startswith("robot.toml:5 · link:send · patterns")
    assert [word for word in words if word not in message] == [], message


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_a_wrong_configuration_is_refused_with_place_and_remedy(name: str, project: Path) -> None:
    text, words = CONFIGURATIONS[name]
    (project / "pyproject.toml").write_text("[tool.mutabot]\n" + text)
    message = refused(load_configuration, project)
    assert message.startswith("pyproject.toml:")
    assert [word for word in words if word not in message] == [], message


def test_patterns_need_the_argument_that_holds_the_command(tmp_path: Path) -> None:
    message = vocabulary_refused(tmp_path, GOOD_OPERATION + "patterns = [ { text = 'up' } ]")
    assert "robot.toml:3" in message
    assert 'message = "…"' in message


def test_the_message_itself_is_no_quantity(tmp_path: Path) -> None:
    text = GOOD_OPERATION + "message = 'm'\narguments.m = { kind = 'output', values = ['a', 'b'] }"
    message = vocabulary_refused(tmp_path, text)
    assert "robot.toml:4 · robot:Arm.move · arguments.m: holds the text command" in message


def test_all_mistakes_of_a_file_are_reported_in_the_order_of_its_lines(tmp_path: Path) -> None:
    text = (
        "chekcs = []\n"
        + GOOD_OPERATION
        + "arguments.dx = { kind = 'rotation', unit = 'm' }\ncurrent = 'no:op'"
    )
    (tmp_path / "robot.toml").write_text(text)
    with pytest.raises(UnknownNameError) as caught:
        load_vocabulary(["robot.toml"], tmp_path)
    lines = str(caught.value).splitlines()
    assert [line.split(" · ")[0] for line in lines] == [f"robot.toml:{n}" for n in (1, 4, 4, 5)]
    assert "'chekcs'; did you mean 'checks'" in lines[0]
    assert (caught.value.file, caught.value.key, caught.value.line) == ("robot.toml", "chekcs", 1)


def test_no_more_than_ten_mistakes_are_reported_one_by_one(tmp_path: Path) -> None:
    message = vocabulary_refused(tmp_path, "".join(f"[[operation]]\ncall = 'a.b{n}'\n" for n in range(25)))
    assert len(message.splitlines()) == 11
    assert message.endswith("… and 15 more")


def test_unlike_descriptions_of_a_call_in_two_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "more.toml").write_text(GOOD_OPERATION + "refusals = ['a:B']")
    (tmp_path / "robot.toml").write_text(GOOD_OPERATION)
    message = refused(load_vocabulary, ["robot.toml", "more.toml"], tmp_path)
    assert message.startswith("more.toml:2 · robot:Arm.move · call: is described twice")
    assert "robot.toml:1" in message


def test_two_clocks_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("clock = { tick = 'a:b' }")
    (tmp_path / "b.toml").write_text("clock = { tick = 'a:c' }")
    assert "described twice, differently: also in a.toml:1" in refused(
        load_vocabulary, ["a.toml", "b.toml"], tmp_path
    )


def test_two_tolerances_of_one_probe_are_refused(tmp_path: Path) -> None:
    message = vocabulary_refused(tmp_path, "[[probe]]\ncall='a:b'\n[[probe]]\ncall='a:b'\ntolerance=1")
    assert "robot.toml:3" in message


def test_an_unknown_vocabulary_is_refused_with_the_nearest_file(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(GOOD_OPERATION)
    assert "'robot.toml'" in refused(load_vocabulary, ["robto.toml"], tmp_path)


def test_a_vocabulary_that_is_not_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_bytes(b"call = '\xff'")
    assert "robot.toml: is not UTF-8" in refused(load_vocabulary, ["robot.toml"], tmp_path)


@pytest.mark.parametrize("files", [{}, {"pyproject.toml": "[project]\nname='a'"}])
def test_without_a_configuration_init_is_proposed(files: dict[str, str], project: Path) -> None:
    for name, text in files.items():
        (project / name).write_text(text)
    assert "mutabot init" in refused(load_configuration, project)


def test_a_misspelt_table_is_named(project: Path) -> None:
    (project / "pyproject.toml").write_text("[tool.mutbot]\n")
    assert "[tool.mutbot]; did you mean [tool.mutabot]" in refused(load_configuration, project)


def test_two_configurations_are_refused(project: Path) -> None:
    (project / "pyproject.toml").write_text("[tool.mutabot]\n" + GOOD)
    (project / "mutabot.toml").write_text(GOOD)
    message = refused(load_configuration, project)
    assert "pyproject.toml:1 · tool.mutabot" in message
    assert "mutabot.toml" in message


@pytest.mark.parametrize("text", ["[tool.mutabot]\n" + GOOD, "tool = 3"])
def test_a_tool_table_in_the_own_file_is_refused(text: str, project: Path) -> None:
    (project / "mutabot.toml").write_text(text)
    assert "mutabot.toml:1 · tool" in refused(load_configuration, project)


@pytest.mark.parametrize("text", ["[tool]\nmutabot = 3", "tool = 3", "[tool.mutabot", "[[tool.mutabot]]"])
def test_a_configuration_of_the_wrong_shape_is_refused(text: str, project: Path) -> None:
    (project / "pyproject.toml").write_text(text)
    refused(load_configuration, project)


def test_a_project_without_tests_is_asked_for_them(project: Path) -> None:
    (project / "tests").rename(project / "checks")
    (project / "mutabot.toml").write_text(GOOD)
    assert "no folder 'tests'" in refused(load_configuration, project)


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    assert "no such folder" in refused(load_configuration, tmp_path / "nowhere")


def test_a_problem_with_a_name_becomes_an_unknown_name_with_its_place() -> None:
    problem = Problem(
        "robot.toml:12 · robot:Arm.move",
        "arguments.dz",
        "robot:Arm.move has no argument 'dz'",
        "dz",
        ("dx", "v"),
    )
    error = problem_error(problem)
    assert isinstance(error, UnknownNameError)
    assert str(error) == (
        "robot.toml:12 · robot:Arm.move · arguments.dz: "
        "robot:Arm.move has no argument 'dz'; did you mean 'dx'?"
    )


def test_a_problem_that_says_only_what_kind_of_name_it_is_becomes_a_sentence() -> None:
    error = problem_error(Problem("robot.toml · a:b", "arguments.dz", "argument", "dz", ("dx",)))
    assert str(error) == "robot.toml · a:b · arguments.dz: unknown argument 'dz'; did you mean 'dx'?"


def test_a_problem_without_a_name_or_a_source_keeps_its_text() -> None:
    error = problem_error(Problem("", "result", "float has no parts"))
    assert type(error) is ConfigurationError
    assert str(error) == "result: float has no parts"


def test_mistakes_of_a_vocabulary_are_vocabulary_errors(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text("[[operation]]\ncall = 'x'")
    with pytest.raises(VocabularyError):
        load_vocabulary(["robot.toml"], tmp_path)
