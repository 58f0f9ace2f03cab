# SPDX-License-Identifier: Apache-2.0
"""YAML files of all kinds, good and hostile: read as meant, or one line with file and line."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import pytest

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots.located_yaml import Value, read_mapping


def value(directory: Path, text: str) -> Value:
    file = directory / "robot.yaml"
    file.write_text(f"first: 1\nkey: {text}\n", encoding="utf-8")
    return read_mapping(file, RobotError).required("key")


def test_integers_fit_64_bits(tmp_path):
    assert value(tmp_path, str(-(2**63))).integer() == -(2**63)
    for text in (str(2**63), "1" * 400, "1" * 5000):
        with pytest.raises(RobotError, match=r":2: key: expected an integer of at most 64 bits"):
            value(tmp_path, text).integer()
    for text in ("1.0", "1_0", "1:30", "0x1"):
        with pytest.raises(RobotError, match=r":2: key: expected an integer, got"):
            value(tmp_path, text).integer()


@pytest.mark.parametrize("text", ["yes", "no", "on", "off", "y", "tRUE", "1", "'true'"])
def test_truth_is_true_or_false(tmp_path, text):
    assert value(tmp_path, "True").truth() is True
    with pytest.raises(RobotError, match=r":2: key: expected true or false, got"):
        value(tmp_path, text).truth()


HOSTILE = {
    "a tag of Python": (b"a: !!python/object/apply:os.system [x]\n", ":1: isn't YAML: the tag"),
    "deep blocks": (
        "".join(f"{' ' * i}a:\n" for i in range(2000)).encode(),
        ":50: isn't YAML: expected at most 50 levels, got more",
    ),
    "a list as a key": (b"[a, b]: 1\n", ":1: expected a text as a key, got a list of 2"),
    "a mapping as a key": (b"? {a: 1}\n: 1\n", ":1: expected a text as a key, got keys with"),
    "a merge": (b"<<: {a: 1}\n", ":1: <<: unknown key"),
    "a NUL": (b"a: 1\nb: \0\n", ":2: isn't YAML: the character '\\x00' isn't allowed"),
    "a control character": (b"a: \x1b[31m\n", ":1: isn't YAML: the character '\\x1b' isn't"),
    "an escape beyond Unicode": (
        b'a: 1\nb: "\\U00110000"\n',
        ":2: isn't YAML: an escape stands for NUL, a surrogate or a code above 10ffff; write",
    ),
    "an escape beyond 31 bits": (
        b'a: "\\U99999999"\n',
        ":1: isn't YAML: an escape stands for NUL,",
    ),
    "half of a surrogate pair": (b'a: 1\nb: "x\\ud800"\n', ":2: isn't YAML: an escape stands for"),
    "a surrogate in a key": (b'"\\udc00": 1\n', ":1: isn't YAML: an escape stands for NUL"),
    "an escaped NUL": (
        b'a:\n  "~nouser\n  \\0/x"\n',
        ":2: isn't YAML: an escape stands for NUL, a",
    ),
    "a version of 5000 digits": (
        b"%YAML 1." + b"1" * 5000 + b"\n---\na: 1\n",
        ":1: isn't YAML: bad YAML version: 1.111",
    ),
    "UTF-16": ("a: 1\n".encode("utf-16"), ":1: isn't text in UTF-8; expected YAML; save it"),
    "UTF-16 without a mark": ("a: 1\n".encode("utf-16-le"), ":1: isn't YAML: the character"),
    "Latin-1": (b"a: 1\nb: caf\xe9\n", ":2: isn't text in UTF-8; expected YAML"),
    "a picture": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", ":1: isn't text in UTF-8; expected YAML"),
    "noise": (bytes(range(256)) * 100, ":2: isn't text in UTF-8"),
    "a tab": (b"a:\n\tb: 1\n", ":2: isn't YAML: a tab is before the text; indent with spaces"),
    "an open bracket": (b"a: [1, 2\n", ":2: isn't YAML: expected ',' or ']'"),
    "a long text": (b"x" * 1_000_000, ":1: expected keys with values, got a text"),
    "a byte order mark alone": (b"\xef\xbb\xbf", ": is empty; expected keys with values"),
    "a directive": (b"%YAML 3.0\n---\na: 1\n", ":1: isn't YAML: expected version 1"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_file_is_one_line_with_its_place(tmp_path, name):
    content, expected = HOSTILE[name]
    file = tmp_path / "robot.yaml"
    file.write_bytes(content)
    start = time.process_time()
    with pytest.raises(RobotError) as caught:
        read_mapping(file, RobotError).reject_others()
    text = str(caught.value)
    assert text.startswith(f"{file}{expected}")
    assert re.fullmatch(r"[^\x00-\x1f]{1,400}", text)
    assert time.process_time() - start < 10.0  # quadratic work would take hours


def test_a_byte_order_mark_is_left_out(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_bytes(b"\xef\xbb\xbfa: 1\n")
    assert read_mapping(file, RobotError).required("a").integer() == 1


def test_encoding_is_utf_8_whatever_the_locale(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "read_text", None)  # what depends on the locale
    assert value(tmp_path, "café").text() == "café"


def test_what_is_no_file_is_one_line(tmp_path):
    with pytest.raises(RobotError, match=r": can't be read \(Is a directory\)$"):
        read_mapping(tmp_path, RobotError)
    with pytest.raises(RobotError, match=r": can't be read \(No such file or directory\)$"):
        read_mapping(tmp_path / "gone.yaml", RobotError)
    with pytest.raises(RobotError, match=r": can't be read \(File name too long\)$"):
        read_mapping(tmp_path / ("x" * 300 + ".yaml"), RobotError)


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read every file")
def test_a_file_that_may_not_be_read_is_one_line(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text("a: 1\n")
    file.chmod(0)
    with pytest.raises(RobotError, match=r": can't be read \(Permission denied\)$"):
        read_mapping(file, RobotError)


def test_escapes_of_characters_are_read(tmp_path):
    assert (
        value(
            tmp_path,
            r'"\x41\u00e9\U0001F600\t\
  b"',
        ).text()
        == "Aé😀\tb"
    )
