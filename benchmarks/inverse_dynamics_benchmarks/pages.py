# SPDX-License-Identifier: Apache-2.0
"""A measurement as Markdown: parts, each by its name, for a page of its own or within another.

In a page that people write, `<!-- ids bench: NAME -->` and `<!-- ids bench: end -->` enclose a part.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from inverse_dynamics.base.files import write_text_whole
from inverse_dynamics.errors import OutputError
from inverse_dynamics_benchmarks import asked
from inverse_dynamics_benchmarks.names import (
    ENGINE,
    ENGINE_BATCHES,
    LIBRARIES,
    OBSERVERS,
    QUANTITIES,
    ROBOTS,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from inverse_dynamics_benchmarks.measurement import Measurement

_MARKED = re.compile(r"<!-- ids bench: (\w+) -->\n(.*?)<!-- ids bench: end -->", re.DOTALL)

_NOTHING = "Not measured.\n"


def page(result: Measurement) -> str:
    """All parts that were measured, under a heading."""
    texts = (PARTS[name](result) for name in PARTS)
    body = "\n".join(text for text in texts if text)
    return f"# Speed of this machine\n\n{body}"


def updated(text: str, result: Measurement, where: str) -> str:
    """A page with its generated parts updated. `where` begins the text of an OutputError."""
    _check_parts(text, where)
    return _MARKED.sub(
        lambda match: (
            f"<!-- ids bench: {match[1]} -->\n{PARTS[match[1]](result) or _NOTHING}"
            "<!-- ids bench: end -->"
        ),
        text,
    )


def check_pages(files: Iterable[Path]) -> None:
    """Raise OutputError unless all of them are pages that update_pages() can update."""
    for file in files:
        _check_parts(_read(file), str(file))


def update_pages(files: Sequence[Path], result: Measurement) -> None:
    """Write pages with their generated parts updated: all of them, or none. Raises OutputError."""
    texts = {file: updated(_read(file), result, str(file)) for file in files}
    for file, text in texts.items():
        write_text_whole(file, text)


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise OutputError(
            f"{file}: can't be read ({reason}); expected a page of Markdown with generated parts"
        ) from error


def _check_parts(text: str, where: str) -> None:
    names = [match[1] for match in _MARKED.finditer(text)]
    if not names:
        raise OutputError(
            f"{where}: expected a part between `<!-- ids bench: NAME -->` and `<!-- ids bench: end "
            f"-->`, got none; NAME is one of {', '.join(PARTS)}"
        )
    for name in names:
        if name not in PARTS:
            raise OutputError(
                f"{where}: part '{name}': expected one of {', '.join(PARTS)}; correct its name"
            )


def machine(result: Measurement) -> str:
    """What was measured with what, a paragraph."""
    context = result.context
    load = ", ".join(
        f"{loads[0]:.1f} {when}"
        for key, when in (("load_avg", "before"), ("load_avg_after", "after"))
        if (loads := context.get(key))
    )
    versions = ", ".join(
        f"{title} {context[key]}" for key, title in LIBRARIES.items() if key in context
    )
    lines = [
        f"{context.get('processor', 'unknown processor')}, {context.get('num_cpus', '?')} cores, "
        f"{context.get('mhz_per_cpu', '?')} MHz; {context.get('compiler', '?')}, "
        f"`{context.get('compiler_flags', '')}`, kernels {context.get('kernels', '?')}; {versions}.",
    ]
    if result.times:
        lines.append(
            f"Least of {context.get('repetitions', '?')} repetitions in random order; their median "
            f"is {100 * (context.get('median_by_least', 1) - 1):.0f} % above it, for half of the "
            f"rows. Load of the machine: {load}."
        )
    missing = [title for key, title in LIBRARIES.items() if key not in (*context, "ours")]
    if missing:
        lines.append(f"Not found when the benchmarks were built: {', '.join(missing)}.")
    if context.get("optimized") == "no":
        lines.append(
            "**Compiled without optimisation: these times say nothing.** Build with "
            "`-DCMAKE_BUILD_TYPE=Release`."
        )
    return "\n".join(lines) + "\n"


def calls(result: Measurement) -> str:
    """One state a call [ns]."""
    robots = [*asked.REAL, *asked.GENERATED, *asked.IDENTIFIED]
    rows = []
    for robot in robots:
        for quantity in QUANTITIES:
            ours = result.time(robot, quantity, "ours")
            pinocchio = asked.peer_time(result, robot, quantity)
            if robot in asked.IDENTIFIED and quantity == "torques":
                pinocchio = asked.peer_time(result, asked.IDENTIFIED[robot], quantity)
            others = [result.time(robot, quantity, library) for library in ("kdl", "mujoco")]
            if ours is not None:
                cells = [_time(t) for t in (ours, pinocchio, *others)]
                rows.append([ROBOTS[robot], QUANTITIES[quantity], *cells, _ratio(pinocchio, ours)])
    return _table(["robot", "quantity [ns]", *LIBRARIES.values(), "ratio"], rows, 2)


def batches(result: Measurement) -> str:
    """1024 states a call [ns per state], beside Pinocchio's single call."""
    rows = []
    for robot in ROBOTS:
        for quantity, title in QUANTITIES.items():
            ours = result.time(robot, f"{quantity}_batch", "ours")
            peer = asked.peer_time(result, asked.IDENTIFIED.get(robot, robot), quantity)
            if robot in asked.IDENTIFIED and quantity != "torques":
                peer = None
            if ours is not None:
                rows.append([ROBOTS[robot], title, _time(ours), _time(peer), _ratio(peer, ours)])
    return _table(["robot", "batch of [ns]", "this library", "Pinocchio", "ratio"], rows, 2)


def generated(result: Measurement) -> str:
    """Beside C that CasADi generates [ns]; share: our time of the better expression's."""
    rows = []
    for robot in asked.REAL:
        for quantity in asked.QUANTITIES:
            ours = result.time(robot, quantity, "ours")
            libraries = ("casadi_templates", "casadi_textbook")
            times = [result.time(robot, quantity, library) for library in libraries]
            best = asked.casadi_time(result, robot, quantity)
            if ours is not None and best is not None:
                cells = [_time(t) for t in (ours, *times)]
                rows.append([ROBOTS[robot], QUANTITIES[quantity], *cells, f"{ours / best:.2f}"])
    heads = [
        "robot",
        "quantity [ns]",
        "this library",
        "of our templates",
        "of the textbook",
        "share",
    ]
    return _table(heads, rows, 2)


def chains(result: Measurement) -> str:
    """Time over the number of joints [ns]; ratio: KDL's time by ours."""
    rows = []
    for robot in asked.CHAINS:
        ours = {q: result.time(robot, q, "ours") for q in asked.QUANTITIES}
        kdl = {q: result.time(robot, q, "kdl") for q in asked.QUANTITIES}
        if any(ours.values()):
            pinocchio = result.time(robot, "torques", "pinocchio")
            rows.append(
                [
                    robot.removeprefix("mixed"),
                    *(_time(t) for t in (ours["torques"], pinocchio, kdl["torques"])),
                    *(_ratio(kdl[q], ours[q]) for q in asked.QUANTITIES),
                ]
            )
    heads = ["joints", "torques [ns]", "Pinocchio", "KDL"]
    heads += [f"KDL by ours: {QUANTITIES[q]}" for q in asked.QUANTITIES]
    return _table(heads, rows, 1)


def engine(result: Measurement) -> str:
    """Functions of the engine [ns]."""
    rows = []
    for robot in (*asked.REAL, *asked.GENERATED):
        for quantity, title in ENGINE.items():
            ours = result.time(robot, quantity, "ours")
            peer = result.time(robot, quantity, "pinocchio")
            if ours is not None:
                rows.append([ROBOTS[robot], title, _time(ours), _time(peer), _ratio(peer, ours)])
    return _table(["robot", "quantity [ns]", "this library", "Pinocchio", "ratio"], rows, 2)


def engine_batches(result: Measurement) -> str:
    """Functions of the engine, 64 states a call [ns per state], beside Pinocchio's single call."""
    rows = []
    for robot in (*asked.REAL, *asked.GENERATED):
        for quantity, title in ENGINE_BATCHES.items():
            ours = result.time(robot, f"{quantity}_batch", "ours")
            peer = result.time(robot, quantity, "pinocchio")
            if ours is not None:
                rows.append([ROBOTS[robot], title, _time(ours), _time(peer), _ratio(peer, ours)])
    return _table(["robot", "batch of [ns]", "this library", "Pinocchio", "ratio"], rows, 2)


def observers(result: Measurement) -> str:
    """Updates of estimators of external torques [ns]."""
    rows = [
        [ROBOTS[robot], title, _time(ours)]
        for robot in ROBOTS
        for quantity, title in OBSERVERS.items()
        if (ours := result.time(robot, quantity, "ours")) is not None
    ]
    return _table(["robot", "one update of [ns]", "this library"], rows, 2)


def memory(result: Measurement) -> str:
    """A batch beyond the caches, and threads [ns per state]."""
    rows = [
        ["262144 states, 50 MB", _time(result.time("ur10", "torques_memory", "ours"))],
        ["sum of the same arrays", _time(result.time("ur10", "torques_memory", "sum"))],
        ["131072 states", _time(result.time("ur10", "torques_many", "ours"))],
        ["131072 states, two threads", _time(result.time("ur10", "torques_many", "two_threads"))],
        ["1024 states, one state per row", _time(result.time("ur10", "torques_rows", "ours"))],
    ]
    return _table(["UR10, torques", "ns"], [row for row in rows if row[1]], 1)


def bounds(result: Measurement) -> str:
    """What is asked of speed, and what was reached. Empty if nothing of it was measured."""
    found = asked.bounds(result)
    if all(bound.reached is None for bound in found):
        return ""
    rows = [
        [_in_words(bound.what), bound.other, f"{bound.asked:g}", *_judged(bound)] for bound in found
    ]
    return _table(["what", "how many times as fast as", "asked", "reached", "holds"], rows, 2)


def _judged(bound: asked.Bound) -> tuple[str, str]:
    """What was reached and where, and whether the bound holds."""
    place = f" ({_in_words(bound.where)})" if bound.where else ""
    if bound.reached is None:
        return f"not measured{place}", ""
    return f"{bound.reached:.3g}{place}", "yes" if bound.holds else "**no**"


def _in_words(names: str) -> str:
    """Names of robots and quantities as the other tables have them."""
    words = {**ROBOTS, **QUANTITIES, **OBSERVERS}
    chains = re.sub(r"\bmixed(\d+)", r"\1 joints", re.sub(r"\bmixed1\b", "1 joint", names))
    return re.sub(r"\w+", lambda name: words.get(name[0], name[0]), words.get(names, chains))


def latency(result: Measurement) -> str:
    """How long single calls take."""
    rows = []
    for entry in result.latency:
        robot, quantity, library = entry["name"].split("/")
        what = quantity if robot == "system" else f"{ROBOTS[robot]}, {QUANTITIES[quantity]}"
        rows.append(
            [
                what if robot != "system" else f"*{what}*",
                LIBRARIES.get(library, ""),
                *(_span(entry[key]) for key in ("slowest_state", "p50", "p99", "p99.99", "max")),
                f"{entry['interruptions_per_second']:.0f}",
                str(entry["context_switches"]),
                str(entry["page_faults"]),
            ]
        )
    if not rows:
        return ""
    number = f"{result.latency[0]['calls']:,}".replace(",", " ")
    heads = ["call", "by", "slowest state", "p50", "p99", "p99.99", "max"]
    heads += ["interrupted/s", "switches", "page faults"]
    return f"{number} of each call.\n\n" + _table(heads, rows, 2)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]], words: int) -> str:
    """Markdown; the first `words` columns are text, the others numbers. Empty without rows."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    rule = "|" + "".join("---|" if i < words else "--:|" for i in range(len(heads)))
    return "\n".join(["| " + " | ".join(heads) + " |", rule, *lines]) + "\n" if lines else ""


def _time(nanoseconds: float | None) -> str:
    if nanoseconds is None:
        return ""
    return f"{nanoseconds:.1f}" if nanoseconds < 30 else f"{nanoseconds:.0f}"


def _span(nanoseconds: float) -> str:
    if nanoseconds >= 999_500:
        return f"{nanoseconds / 1e6:.3g} ms"
    return f"{nanoseconds / 1e3:.3g} µs" if nanoseconds >= 9_999.5 else f"{nanoseconds:.0f} ns"


def _ratio(slow: float | None, fast: float | None) -> str:
    value = asked.ratio(slow, fast)
    return "" if value is None else f"{value:.1f}"


PARTS: Mapping[str, Callable[[Measurement], str]] = {
    "machine": machine,
    "calls": calls,
    "batches": batches,
    "generated": generated,
    "memory": memory,
    "chains": chains,
    "engine": engine,
    "engine_batches": engine_batches,
    "observers": observers,
    "latency": latency,
    "bounds": bounds,
}
