# SPDX-License-Identifier: Apache-2.0
"""YAML files of all kinds, good and hostile: read as meant, or one line with file and line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from inverse_dynamics.errors import RobotError
from inverse_dynamics.robots.located_yaml import Value, read_mapping


def value(directory: Path, text: str) -> Value:
    file = directory / "robot.yaml"
    file.write_text(f"first: 1\nkey: {text}\n", encoding="utf-8")
    return read_mapping(file, RobotError).required("key")


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
