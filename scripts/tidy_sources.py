#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the C++ sources and headers that a change touches, or all; called by `./scripts/lint tidy`.

Usage: python3 tidy_sources.py COMMIT|all

A change touches a file that differs from COMMIT, and a source that includes a header that does. First
writes build/clang_tidy/compile_commands.json: how each source is compiled by itself, also where the build
compiles several at a time (a unity build), and each header: as a source of its package that includes it.
"""

import json
import re
import shlex
import subprocess
import sys
from os.path import commonpath
from pathlib import Path

INCLUDE = re.compile(r'^#include "(.*\.cpp)"$', re.MULTILINE)
GCC_ONLY = {"-flive-range-shrinkage"}  # an error for Clang
AS_SOURCE = ["-Wno-pragma-once-outside-header", "-x", "c++", "-c"]


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


def header_command(header: str, sources: list[dict[str, str]]) -> dict[str, str] | None:
    """Compiles a header by itself, if its package is part of the build."""
    path = str(Path.cwd() / header)
    package = f"{Path.cwd() / header.split('/')[0]}/"
    of_package = [entry for entry in sources if entry["file"].startswith(package)]
    if not of_package:
        return None

    def nearness(source: str) -> tuple[bool, int]:
        return f'{Path(header).name}"' in Path(source).read_text(), len(commonpath([source, path]))

    near = max(of_package, key=lambda entry: nearness(entry["file"]))
    words = shlex.split(near["command"])
    place = words.index(near["file"])  # after -c
    return {**near, "file": path, "command": shlex.join([*words[: place - 1], *AS_SOURCE, path])}


database = Path("build/clang_tidy/compile_commands.json")
database.parent.mkdir(exist_ok=True)
entries = json.loads(Path("build/compile_commands.json").read_text())
commands = [own for entry in entries for own in own_commands(entry)]
# Code of pages includes what the pages show.
apart = (":!:*/without_ros/*", ":!:documentation_tests")
headers = git("ls-files", "*/include/*.hpp", "*/src/*.hpp", "*/test/*.hpp", *apart)
of_headers = [header_command(header, commands) for header in headers]
database.write_text(json.dumps([*commands, *filter(None, of_headers)], indent=1))
files = [*git("ls-files", "*/src/*.cpp", "*/test/*.cpp", apart[1]), *headers]
chosen = files if sys.argv[1] == "all" else sorted(touched(sys.argv[1]).intersection(files))
sys.stdout.writelines(f"{file}\n" for file in chosen)
