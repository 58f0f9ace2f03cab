# SPDX-License-Identifier: Apache-2.0
import pytest

from inverse_dynamics.errors import BagError, EvaluationError, UserError
from inverse_dynamics.wording import TERMINAL, counted, did_you_mean, shown


@pytest.mark.parametrize(("count", "expected"), [(0, "0 joints"), (1, "1 joint"), (2, "2 joints")])
def test_one_thing_is_not_many(count, expected):
    assert counted(count, "joint") == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tool0", "'tool0'"),
        ("it's", "'it's'"),
        ("café", "'café'"),
        ("a\x1b[31m\nb", "'a\\x1b[31m\\nb'"),
        ("x" * 100_000, "'" + "x" * 60 + "...'"),
        (12, "'12'"),
    ],
)
def test_what_a_file_says_is_short_and_harmless_in_a_message(text, expected):
    assert shown(text) == expected


def test_a_word_like_a_known_one_is_proposed():
    known = ("evaluate", "export", "tool0", "tip", "topic")
    assert did_you_mean("tpi", known) == "did you mean tip?"
    assert did_you_mean("evalute", known) == "did you mean evaluate?"
    assert did_you_mean("tol0", known) == "did you mean tool0?"
    assert did_you_mean("simulate it", known) == ""
    assert did_you_mean("x" * 10_000_000, known) == ""


def test_the_text_of_an_error_is_short_and_harmless():
    error = BagError(f"bag: joints a\x1b[31m\r, {'x' * 100_000}: expected others:\n  b\n  c")
    text = str(error)
    assert text.startswith(r"bag: joints a\x1b[31m\x0d, xxx")
    assert text.endswith("xxx: expected others:\n  b\n  c")
    assert len(text) < 1000
    assert str(EvaluationError("a\x1b", "b")) == r"('a\x1b', 'b')"
    assert str(UserError("plain 'text' of café")) == "plain 'text' of café"


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("state --columns 'time=t', or --rate", "state columns='time=t', or rate="),
        ("State --scale q=deg, or one", "State scale=['q=deg'], or one"),
        ("--quiet (quiet=): expected", "quiet: expected"),
        ("give --quiet FROM,TO [s]", "give quiet=(FROM, TO) [s]"),
        ("give --gravity 0,0,9.81, or", "give gravity=(0, 0, 9.81), or"),
        ("give --effort-is current, and", "give effort_is='current', and"),
        ("the same --effort-is and gains", "the same effort_is= and gains"),
        ("give them with --torque", "give them with limits=MotionLimits(torque=...)"),
        ("--tip other: the model", "tip='other': the model"),
        ("choose --from and --to in", "choose start= and end= in"),
        ("replace it with --overwrite", "replace it with overwrite=True"),
        ("give --accept mass --accept gain", "give accept=['mass', 'gain']"),
        (
            "give --payload 2.5,0,0.1,0, or",
            "give parameters={'payload.mass': 2.5, 'payload.center_of_mass': [0, 0.1, 0]}, or",
        ),
        ("at --parameter locked_joints.J=...", "at parameters={'locked_joints.J': ...}"),
        ("give gains (ids: --drive-gains), one", "give gains, one"),
        ("with `ros2 topic echo --csv`, or", "with `ros2 topic echo --csv`, or"),
        ("ids identify X --out a.yaml, or", "ids identify X --out a.yaml, or"),
        ("x--y and a - b -- c", "x--y and a - b -- c"),
    ],
)
def test_errors_name_arguments_in_python_and_options_in_a_terminal(text, spoken, monkeypatch):
    assert f"{UserError(text)}" == spoken
    monkeypatch.setenv(TERMINAL, "1")
    assert f"{UserError(text)}" == text
