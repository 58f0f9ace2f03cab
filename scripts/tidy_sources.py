#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which C++ sources clang-tidy has to check: those that a change touches, or all.

A change is what differs from where this branch left the main branch; on the main branch itself, from
the commit that the environment variable CHANGED_SINCE names (the workflow states the one before a
push), else from the commit before. Files that aren't committed count. A change touches a source that
is changed, includes a changed header (Ninja knows that from the last build), or lies below a changed
CMakeLists.txt.

Prints the sources, one per line, and on the standard error output why it is these. First writes
build/clang_tidy/compile_commands.json: how each of them is compiled by itself, also where the build
compiles several at a time (a unity build).
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path, PurePosixPath

MAIN_BRANCHES = ("origin/HEAD", "origin/main", "main")
RULES = {".clang-tidy", "scripts/lint"}
_OBJECT = re.compile(r"^\S.*: #deps \d+")
_INCLUDE = re.compile(r'^#include "(.*\.cpp)"$', re.MULTILINE)
GCC_ONLY = {"-flive-range-shrinkage"}  # an error for Clang


def sources_to_check(root: Path, everything: bool = False) -> tuple[list[str], str]:
    """Sources below `root`, relative to it, and the reason for the choice."""
    sources = _lines(root, "ls-files", "--cached", "--others", "--exclude-standard", "*/src/*.cpp")
    sources = sorted(s for s in sources if (root / s).is_file())
    if everything:
        return sources, f"all {len(sources)} sources"
    base, where = comparison(root)
    if base is None:
        return sources, f"all {len(sources)} sources: {where}"
    changed = changed_files(root, base)
    for name in sorted(changed):
        if not RULES.isdisjoint((name, PurePosixPath(name).name)):
            return sources, f"all {len(sources)} sources: {name} changed {where}"
    includes = included_files(root)
    chosen = [s for s in sources if s in changed or _touched(s, includes, changed)]
    return chosen, f"{len(chosen)} of {len(sources)} sources: what changed {where} touches these"


def comparison(root: Path) -> tuple[str | None, str]:
    """The commit to compare with, if there is one, and what it is."""
    head = _commit(root, "HEAD")
    for branch in MAIN_BRANCHES:
        base = _lines(root, "merge-base", branch, "HEAD")
        if base and base[0] != head:
            return base[0], f"since {base[0][:10]}, where this branch left {branch}"
    if stated := os.environ.get("CHANGED_SINCE"):
        # It isn't there at the first push of a branch, or if the branch was rewritten.
        if _commit(root, stated) is None:
            return None, f"this clone has no commit {stated[:10]}, which CHANGED_SINCE names"
        return stated, f"since {stated[:10]}, which CHANGED_SINCE names"
    parent = _commit(root, "HEAD^")
    if parent is not None:
        return parent, f"since {parent[:10]}, the commit before"
    return None, "this clone has no commit to compare with (git fetch --unshallow brings them)"


def changed_files(root: Path, base: str) -> set[str]:
    """Files that differ from a commit, those that git doesn't know yet among them."""
    differing = _lines(root, "diff", "--name-only", "--no-renames", base)
    return {*differing, *_lines(root, "ls-files", "--others", "--exclude-standard")}


def write_database(root: Path) -> None:
    """Writes build/clang_tidy/compile_commands.json."""
    entries = json.loads((root / "build/compile_commands.json").read_text())
    database = root / "build/clang_tidy/compile_commands.json"
    database.parent.mkdir(exist_ok=True)
    database.write_text(json.dumps([own for e in entries for own in _own_commands(e)], indent=1))


def _own_commands(entry: dict[str, str]) -> list[dict[str, str]]:
    words = [word for word in shlex.split(entry["command"]) if word not in GCC_ONLY]
    file = Path(entry["directory"], entry["file"])
    sources = _INCLUDE.findall(file.read_text()) if "Unity" in file.parts else [entry["file"]]
    return [
        entry
        | {
            "file": source,
            "command": shlex.join(source if word == entry["file"] else word for word in words),
        }
        for source in sources
    ]


def included_files(root: Path) -> dict[str, set[str]]:
    """By source: what it includes, itself among it, as the last build of each package found.

    Sources that are compiled at a time count with all headers of them all.
    """
    includes: dict[str, set[str]] = {}
    for log in sorted(root.glob("build/*/.ninja_deps")):
        command = ["ninja", "-C", str(log.parent), "-t", "deps"]
        deps = subprocess.run(command, capture_output=True, text=True, check=False)
        for files in _files_of_objects(deps.stdout):
            names = {_in_repository(root, log.parent, file) for file in files}
            sources = {name for name in names if name.endswith(".cpp")}
            for name in sources:
                includes.setdefault(name, {name}).update(names - sources)
    return includes


def _files_of_objects(deps: str) -> list[list[str]]:
    objects: list[list[str]] = []
    for line in deps.splitlines():
        if _OBJECT.match(line):
            objects.append([])
        elif line.startswith("    ") and objects:
            objects[-1].append(line.strip())
    return objects


def _in_repository(root: Path, build: Path, file: str) -> str:
    # Lexically: where links lead doesn't matter. ccache and Ninja write paths from the build.
    path = PurePosixPath(_normal(build / file))
    try:
        parts = path.relative_to(_normal(root)).parts
    except ValueError:
        return str(path)
    # Other packages include the installed copy of a header: install/PACKAGE/include/...
    return "/".join(parts[1:] if parts[:1] == ("install",) else parts)


def _normal(path: Path) -> str:
    parts: list[str] = []
    for part in path.absolute().parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return str(Path(*parts))


def _touched(source: str, includes: dict[str, set[str]], changed: set[str]) -> bool:
    # How it is compiled may have changed.
    if any(f"{folder}/CMakeLists.txt" in changed for folder in PurePosixPath(source).parents):
        return True
    # Of a source that wasn't built with Ninja, nothing is known.
    return source not in includes or not includes[source].isdisjoint(changed)


def _commit(root: Path, name: str) -> str | None:
    lines = _lines(root, "rev-parse", "--quiet", "--verify", f"{name}^{{commit}}")
    return lines[0] if lines else None


def _lines(root: Path, *arguments: str) -> list[str]:
    git = ["git", "-C", str(root), "-c", "core.quotePath=off", *arguments]
    return subprocess.run(git, capture_output=True, text=True, check=False).stdout.splitlines()


def main() -> None:
    """Print them."""
    root = Path(__file__).resolve().parent.parent
    write_database(root)
    sources, reason = sources_to_check(root, everything="--all" in sys.argv[1:])
    print(f"    clang-tidy: {reason}", file=sys.stderr)
    for source in sources:
        print(source)


if __name__ == "__main__":
    main()
