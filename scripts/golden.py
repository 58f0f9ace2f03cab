#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Golden outputs: what every verb of `ids` and the Python API print and write, before and after a change.

golden.py make DIR [CASE...]              run the cases of golden_cases.txt; CASE: names, with * and ?
golden.py compare DIR_A DIR_B [CASE...]   byte for byte; exit status 1 if something differs

DIR/CASE holds the files that a case writes, and its commands with exit status and output in 00.txt, 01.txt, ...
Made once and kept: DIR/inputs, for all cases; for the same inputs as another time give --inputs DIR_A/inputs.
Recordings of real robots are those of IDS_DATA_DIR; further inputs are given by --more. Times are printed, not stored.
"""

from __future__ import annotations

import argparse
import difflib
import inspect
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass
from fnmatch import fnmatch
from io import BytesIO
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
MARK = "golden.txt"  # in DIR: its absolute path when it was made
MASKS = (  # paths of the installation, files of reports, lines of progress, places of warnings, addresses, a date
    (rb"(?<![\w.+@~/-])(?:/[\w.+@~-]+)+(?=/share/inverse_dynamics_robots/)", b"PREFIX"),
    (rb"/\w+/ids-error-\w+\.txt", b"REPORT"),
    (rb"ids: [^\n]*: \d+ % done after \d+ s \.\.\.\n", b""),
    (rb"(?<![\w.+@~/-])(?:/[\w.+@~-]+)+\.py:\d+(?=: \w+Warning)", b"MODULE"),
    (rb" at 0x[0-9a-f]+>", b">"),
    (rb"Created on: [\w :]{24}", b""),  # in the .mat file of the inputs
)

Cases = dict[str, list[list[str]]]  # commands: words, or `>>>` and a program


def read_cases() -> Cases:
    """golden_cases.txt: names; below them commands, indented; of a name with *, each command is a case."""
    cases: Cases = {}
    name = ""
    for line in (HERE / "golden_cases.txt").read_text().splitlines():
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        if line[0] != " ":
            name = text
            continue
        text = re.sub(r"(?<![\w`])@", "" if name == "inputs" else "../inputs/", text)
        case = name
        if name.endswith("*"):
            case = f"{name[:-1]}{sum(c.startswith(name[:-1]) for c in cases):02d}"
        commands = cases.setdefault(case, [])
        if text.startswith(">>>") and commands and commands[-1][0] == ">>>":
            commands[-1][1] += text[4:] + "\n"
        else:
            commands.append([">>>", text[4:] + "\n"] if text[0] == ">" else shlex.split(text))
    return cases


def run_case(directory: Path, commands: list[list[str]], ids: list[str]) -> float:
    """Run them in the directory; gives the time [s] that it took."""
    start = time.monotonic()
    environment = {
        **{name: value for name, value in os.environ.items() if not name.startswith("IDS_")},
        **{"COLUMNS": "110", "LC_ALL": "C.UTF-8", "TZ": "UTC", "OPENBLAS_NUM_THREADS": "1"},
        "XDG_DATA_HOME": f"{directory.parent}/inputs/nothing",
        "PYTHONPATH": os.pathsep.join(filter(None, (os.environ.get("PYTHONPATH"), f"{HERE}"))),
    }
    for number, command in enumerate(commands):
        python = [sys.executable, "-W", "ignore"]
        words = [*ids, *command]
        if command[0] == ">>>":
            program = (
                f"import numpy as np, inverse_dynamics as ids\nfrom golden import *\n{command[1]}"
            )
            words = [*python, "-c", program]
        elif command[0] == "python":
            words = [*python, *command[1:]]
        try:
            done = subprocess.run(
                words, cwd=directory, env=environment, capture_output=True, timeout=400, check=False
            )
            status, out, err = f"{done.returncode}", done.stdout, done.stderr
        except subprocess.TimeoutExpired:
            status, out, err = "none, it takes too long", b"", b""
        said = f"$ {command[1] if command[0] == '>>>' else shlex.join(command)}\nexit status {status}\n"
        (directory / f"{number:02d}.txt").write_bytes(said.encode() + out + b"--- stderr\n" + err)
    return time.monotonic() - start


def make(arguments: argparse.Namespace) -> int:
    """Run the cases."""
    root: Path = arguments.directory.resolve()
    inputs = root / "inputs"
    cases = read_cases()
    prepare = cases.pop("inputs")
    root.mkdir(parents=True, exist_ok=True)
    (root / MARK).write_text(f"{root}\n")
    if not inputs.exists() and arguments.inputs:
        shutil.copytree(arguments.inputs, inputs)
    elif not inputs.exists():
        shipped = HERE.parent / "inverse_dynamics_robots"
        for part in ("recordings", "urdf", "robots", "models", "trajectories"):
            shutil.copytree(shipped / part, inputs / part)
        if data := os.environ.get("IDS_DATA_DIR"):
            shutil.copytree(Path(data) / "bags", inputs / "bags")
        for more in arguments.more:
            shutil.copytree(more, inputs / more.name, copy_function=shutil.copyfile)
        for found in (inputs, *inputs.rglob("*")):  # the originals may be read-only
            found.chmod(0o755 if found.is_dir() else 0o644)
        print(f"{run_case(inputs, prepare, arguments.ids):6.1f} s  inputs", flush=True)
    chosen = {n: c for n, c in cases.items() if wanted(n, arguments.cases)}
    for name in chosen:
        shutil.rmtree(root / name, ignore_errors=True)
        (root / name).mkdir()
    with ThreadPoolExecutor(arguments.jobs) as pool:
        times = pool.map(lambda n: run_case(root / n, chosen[n], arguments.ids), chosen)
        for name, seconds in zip(chosen, times, strict=True):
            print(f"{seconds:6.1f} s  {name}", flush=True)
    return 0


def wanted(name: str, patterns: list[str]) -> bool:
    """Whether a case is asked for."""
    return not patterns or any(fnmatch(name, pattern) for pattern in patterns)


def contents(root: Path, patterns: list[str]) -> dict[str, bytes]:
    """Files below DIR, masked."""
    made_as = (root / MARK).read_text().strip()
    found = {}
    for file in sorted(root.rglob("*")):
        name = f"{file.relative_to(root)}"
        if name == MARK or not file.is_file() or not wanted(name.partition("/")[0], patterns):
            continue
        content = file.read_bytes().replace(made_as.encode(), b"DIR")
        for pattern, replacement in MASKS:
            content = re.sub(pattern, replacement, content)
        found[name] = content
    return found


def difference(name: str, old: bytes, new: bytes) -> list[str]:
    """The first differing lines, cut to where they differ; of arrays, how much they differ."""
    if name.endswith(".npz"):
        return arrays_difference(old, new) or ["the arrays are equal, the files aren't"]
    if b"\0" in old + new or name.endswith(".pdf"):
        return [f"{len(old)} and {len(new)} bytes, first difference at {first(old, new)}"]
    a, b = (text.decode(errors="backslashreplace").splitlines() for text in (old, new))
    if len(a) + len(b) < 4000:
        lines = list(difflib.unified_diff(a, b, n=0, lineterm=""))[2:]
        a, b = ([line[1:] for line in lines if line[0] == sign] for sign in "-+")
    pairs = [(x, y) for x, y in zip_longest(a, b) if x != y]
    shown = []
    for pair in pairs[:4]:
        cut = max(first(*(line or "" for line in pair)) - 60, 0)
        shown += [
            f"{s} {line[cut : cut + 150]}" for s, line in zip("-+", pair, strict=True) if line
        ]
    return shown + [f"... {len(pairs)} lines"] * (len(pairs) > 4)


def first(a: bytes | str, b: bytes | str) -> int:
    """The first place where they differ."""
    return next((k for k, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))  # noqa: B905


def arrays_difference(old: bytes, new: bytes) -> list[str]:
    """Arrays that differ."""
    a, b = (dict(np.load(BytesIO(content), allow_pickle=False)) for content in (old, new))
    lines = (
        [f"only in one of them: {', '.join(a.keys() ^ b.keys())}"] if a.keys() ^ b.keys() else []
    )
    for key in a.keys() & b.keys():
        if a[key].shape != b[key].shape or a[key].dtype.kind != "f":
            same = np.array_equal(a[key], b[key])
            lines += [] if same else [f"{key}: {a[key].shape} and {b[key].shape}"]
        elif not np.array_equal(a[key], b[key], equal_nan=True):
            lines.append(f"{key}: up to {np.nanmax(np.abs(a[key] - b[key])):.3g}")
    return lines


def compare(arguments: argparse.Namespace) -> int:
    """Say what differs."""
    old, new = (contents(root, arguments.cases) for root in (arguments.a, arguments.b))
    differing = 0
    for name in sorted(old.keys() | new.keys()):
        if name not in old or name not in new:
            print(f"{name}: only in {arguments.a if name in old else arguments.b}")
        elif old[name] != new[name]:
            print(f"{name}:", *difference(name, old[name], new[name]), sep="\n    ")
        else:
            continue
        differing += 1
    print(f"{differing} of {len(old.keys() | new.keys())} files differ")
    return 1 if differing else 0


def show(value: Any, name: str = "result", depth: int = 3) -> None:
    """Print what a result says in public: attributes, signatures of methods; all digits."""
    if isinstance(value, np.ndarray):
        flat = value.ravel()
        some = [
            flat[k].item() for k in np.linspace(0, flat.size - 1, min(flat.size, 12), dtype=int)
        ]
        print(f"{name} = array {value.shape} {value.dtype} {some} sum {value.sum()!r}")
    elif isinstance(value, (list, tuple)) and any(map(is_dataclass, value)) and depth:
        for k, part in enumerate(value):
            show(part, f"{name}[{k}]", depth - 1)
    elif is_dataclass(value) or depth == 3:
        print(
            f"{name}: {type(value).__name__} {fields(value) and [f.name for f in fields(value)]}"
            if is_dataclass(value)
            else f"{name}: {type(value).__name__} {value}"
        )
        for part in (p for p in dir(value) if p[0] != "_" and depth):
            try:
                found = getattr(value, part)
            except Exception as error:
                found = error
            if inspect.isroutine(found):
                print(f"{name}.{part}{signature(found)}")
            else:
                show(found, f"{name}.{part}", depth - 1)
    else:
        print(f"{name} = {value!r}")


def signature(value: Any) -> str:
    """Its signature, if it has one."""
    try:
        return f"{inspect.signature(value)}"
    except (TypeError, ValueError):
        return "(...)"


def show_names(module: Any) -> None:
    """Print the public names of a module with signatures and docstrings, and those of its classes."""
    public = getattr(module, "__all__", [n for n in dir(module) if n[0] != "_"])
    print(module.__name__, sorted(public), module.__doc__)
    for name in sorted(public):
        value = getattr(module, name)
        print(f"\n{name}: {type(value).__name__} {signature(value)}\n{inspect.getdoc(value)}")
        if isinstance(value, type):
            print(f"bases {[base.__name__ for base in value.__mro__[1:]]}")
            for part in (p for p in dir(value) if p[0] != "_"):
                found = inspect.getattr_static(value, part)
                print(f"  {name}.{part}: {type(found).__name__} {signature(getattr(value, part))}")
                print(f"    {inspect.getdoc(getattr(value, part))}")


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    verbs = parser.add_subparsers(required=True)
    maker = verbs.add_parser("make")
    maker.add_argument("directory", type=Path)
    maker.add_argument("--ids", type=shlex.split, default=["ids"], help="the command")
    maker.add_argument("--inputs", type=Path, help="inputs of another DIR")
    maker.add_argument("--more", type=Path, nargs="+", default=[], help="directories of inputs")
    maker.add_argument("--jobs", type=int, default=2)
    maker.set_defaults(run=make)
    comparer = verbs.add_parser("compare")
    comparer.add_argument("a", type=Path)
    comparer.add_argument("b", type=Path)
    comparer.set_defaults(run=compare)
    for verb in (maker, comparer):
        verb.add_argument("cases", nargs="*", metavar="CASE", help="names, with * and ?")
    arguments = parser.parse_args()
    return int(arguments.run(arguments))


if __name__ == "__main__":
    sys.exit(main())
