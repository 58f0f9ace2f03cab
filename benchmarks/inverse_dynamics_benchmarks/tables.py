# SPDX-License-Identifier: Apache-2.0
"""A measurement as tables, in Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from inverse_dynamics_benchmarks.names import LIBRARIES, QUANTITIES, ROBOTS, in_words

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from inverse_dynamics_benchmarks.measurement import Measurement


def page(result: Measurement) -> str:
    """What was measured with what, times, and how long single calls take."""
    parts = (machine(result), times(result), latency(result))
    return "# Speed of this machine\n\n" + "\n".join(filter(None, parts))


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


def times(result: Measurement) -> str:
    """Time of one state [ns] by each library; of a batch, too. ratio: the best other by ours."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for name, time in result.times.items():
        robot, quantity, library = name.split("/")
        found.setdefault((robot, quantity), {})[library] = time
    libraries = [*LIBRARIES, *sorted({key for row in found.values() for key in row} - {*LIBRARIES})]
    rows = []
    for (robot, quantity), row in found.items():
        single = found.get((robot, quantity.removesuffix("_batch")), {})
        others = [single[key] for key in LIBRARIES if key in single and key != "ours"]
        ratio = f"{min(others) / row['ours']:.1f}" if others and "ours" in row else ""
        cells = [_time(row.get(library)) for library in libraries]
        rows.append([in_words(robot), in_words(quantity), *cells, ratio])
    heads = [LIBRARIES.get(library, library) for library in libraries]
    return _table(["robot", "quantity [ns]", *heads, "ratio"], rows, 2)


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
