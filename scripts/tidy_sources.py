#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the C++ sources that a change touches, or all of them; called by `./scripts/lint tidy`.

Usage: python3 tidy_sources.py COMMIT|all

A change touches a source that differs from COMMIT, or that includes a header that does. First writes
build/clang_tidy/compile_commands.json: how each source is compiled by itself, also where the build
compiles several at a time (a unity build).
"""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

INCLUDE = re.compile(r'^#include "(.*\.cpp)"$', re.MULTILINE)
GCC_ONLY = {"-flive-range-shrinkage"}  # an error for Clang


def git(*arguments: str) -> list[str]:
    """Lines of what a git command prints."""
    done = subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)
    return done.stdout.splitlines()


def touched(commit: str) -> set[str]:
    """Sources that differ from a commit or include a header that does."""
    changed = git("diff", "--name-only", "--no-renames", commit, "--", "*.cpp", "*.hpp")
    headers = [f'-e/{Path(name).name}[">]' for name in changed if name.endswith(".hpp")]
    return {*changed, *(git("grep", "-lE", *headers, "--", "*/src/*.cpp") if headers else [])}


def own_commands(entry: dict[str, str]) -> list[dict[str, str]]:
    """Commands that compile each source of an entry by itself."""
    file = Path(entry["directory"], entry["file"])
    sources = INCLUDE.findall(file.read_text()) if "Unity" in file.parts else [entry["file"]]
    words = [word for word in shlex.split(entry["command"]) if word not in GCC_ONLY]
    own = {source: [source if w == entry["file"] else w for w in words] for source in sources}
    return [{**entry, "file": file, "command": shlex.join(own[file])} for file in own]


database = Path("build/clang_tidy/compile_commands.json")
database.parent.mkdir(exist_ok=True)
entries = json.loads(Path("build/compile_commands.json").read_text())
database.write_text(json.dumps([own for entry in entries for own in own_commands(entry)], indent=1))
sources = git("ls-files", "*/src/*.cpp")
chosen = sources if sys.argv[1] == "all" else sorted(touched(sys.argv[1]).intersection(sources))
sys.stdout.writelines(f"{source}\n" for source in chosen)
