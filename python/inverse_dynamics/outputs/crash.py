# SPDX-License-Identifier: Apache-2.0
"""An unexpected error in one line, and the rest of it in a file to send to the maintainers."""

from __future__ import annotations

import os
import tempfile
from typing import TYPE_CHECKING

from inverse_dynamics.installation.extras import missing

if TYPE_CHECKING:
    from collections.abc import Sequence

_PACKAGES = ("numpy", "matplotlib", "mujoco", "pyarrow", "rich", "rosbags")


def crash_report(error: Exception, arguments: Sequence[str]) -> str:
    """Write a report of an error that nobody expected; gives one line that names it.

    A Python package that isn't installed has no report: the line names the command that installs it.

    The report holds the traceback, the command line and versions, and nothing of the environment. A
    report that can't be written is left out: never raises.
    """
    if isinstance(error, ModuleNotFoundError) and error.name:
        return str(missing("ids", error.name.partition(".")[0]))
    what = str(error).strip().partition("\n")[0]
    line = f"unexpected {type(error).__name__}{what and f': {what}'}"
    try:
        handle, name = tempfile.mkstemp(prefix="ids-error-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write(_report(error, arguments))
    except Exception as problem:
        return f"{line} (no report of it could be written: {problem})"
    return f"{line}; this is a bug in ids: please report it with {name}"


def _report(error: Exception, arguments: Sequence[str]) -> str:
    import platform
    import shlex
    import traceback
    from importlib import metadata

    versions = [f"Python {platform.python_version()}, {platform.platform()}"]
    for package in _PACKAGES:
        try:
            versions.append(f"{package} {metadata.version(package)}")
        except metadata.PackageNotFoundError:
            versions.append(f"{package} is not installed")
    command = shlex.join(["ids", *arguments])
    text = "".join(traceback.format_exception(error))
    return "\n".join((command, *versions, "", text))
