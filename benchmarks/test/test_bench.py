# SPDX-License-Identifier: Apache-2.0
import json
import os
import re
from pathlib import Path

import pytest

from inverse_dynamics.base.ament import PackageNotFoundError, package_share
from inverse_dynamics_benchmarks import bounds, measure, page, read_measurement, write_measurement
from inverse_dynamics_benchmarks.measurement import measurement
from inverse_dynamics_benchmarks.pages import PARTS, updated

DOCS = Path(__file__).parents[2] / "docs"
PAGES = ("speed.md", "real_time.md")


def fails(result, *expected):
    """The user is told, on stderr; exit code 2."""
    code, out, err = result
    assert (code, out) == (2, "")
    for part in expected:
        assert part in err


def entry(name, time, *, real=0.0, **more):
    """Of Google Benchmark's JSON, as random interleaving with aggregates writes it."""
    return {
        "name": f"{name}_min",
        "run_name": name,
        "run_type": "aggregate",
        "aggregate_name": "min",
        "real_time": real,
        "cpu_time": time,
        "time_unit": "ns",
        **more,
    }


def document(*entries, **context):
    return {"context": {"processor": "Abacus", **context}, "benchmarks": list(entries)}


@pytest.fixture
def speed_json(tmp_path):
    file = tmp_path / "speed.json"
    entries = [
        entry("ur10/torques/ours", 100.0),
        entry("ur10/torques/pinocchio", 900.0),
        entry("ur10/torques/kdl", 1500.0),
        entry("panda/torques/ours", 200.0),
        entry("panda/torques/pinocchio", 1400.0),
        entry("ur10/torques_batch/ours/real_time", 1.0, real=25_600.0, states=1024),
    ]
    file.write_text(json.dumps(document(*entries)))
    return file


def benchmarks_installed():
    try:
        prefix = package_share("inverse_dynamics_benchmarks").parents[1]
    except PackageNotFoundError:
        return False
    return (prefix / "bin/inverse_dynamics_benchmark").is_file()


needs_benchmarks = pytest.mark.skipif(
    not benchmarks_installed(),
    reason="without the benchmarks (./scripts/build --all; Debian: libbenchmark-dev)",
)


def test_help_teaches_by_examples(ids):
    code, out, _ = ids("bench", "--help")
    assert code == 0
    assert "  ids bench --only ur10/torques " in out
    assert "  bench " in ids("--help")[1]


@needs_benchmarks
def test_one_command_measures_and_writes_everything(ids, tmp_path):
    options = ["--repetitions", "2", "--seconds", "1e-6", "--only", "^ur10/torques(_batch)?/"]
    files = ["--json", "out/a.json", "--markdown", "out/a.md", "--plot", "out/a.svg"]
    code, out, err = ids("bench", *options, "--latency", "--calls", "100", *files)
    assert (code, err) == (0, "")
    assert re.search(r"UR10 +torques +\d", out)
    result = read_measurement(tmp_path / "out/a.json")
    for library in ("ours", "kdl"):
        assert 1 < result.time("ur10", "torques", library) < 1e7
    assert 1 < result.time("ur10", "torques_batch", "ours") < 1e7
    assert result.context["repetitions"] == 2
    assert re.search(r"gcc|clang", result.context["compiler"])
    assert page(result) == (tmp_path / "out/a.md").read_text()
    for row in result.latency:
        assert row["calls"] == 100
        assert row["p50"] <= row["p99"] <= row["p99.99"] <= row["max"]
    names = [row["name"] for row in result.latency]
    assert names[:2] == ["system/nothing/none", "system/multiplications/none"]
    assert "ur10_identified/torques/ours" in names
    assert "<svg" in (tmp_path / "out/a.svg").read_text()


@needs_benchmarks
def test_a_name_that_no_benchmark_has_is_told(ids):
    fails(
        ids("bench", "--only", "nonsense"),
        "inverse_dynamics_benchmark failed: Failed to match any benchmarks against regex: nonsense; "
        "names are ROBOT/QUANTITY/LIBRARY, such as ur10/torques/ours",
    )


def test_without_the_benchmarks_the_remedy_is_told(ids, tmp_path, monkeypatch):
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    build = "`./scripts/build --packages-select inverse_dynamics_benchmarks`"
    fails(ids("bench"), "inverse_dynamics_benchmarks: not in any", f"only on request: {build}")

    marker = tmp_path / "share/ament_index/resource_index/packages/inverse_dynamics_benchmarks"
    marker.parent.mkdir(parents=True)
    marker.touch()
    fails(
        ids("bench"),
        "bin/inverse_dynamics_benchmark: not there",
        "apt install libbenchmark-dev",
        build,
    )


def test_a_benchmark_that_fails_is_told_by_its_last_words(tmp_path, monkeypatch):
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "inverse_dynamics_benchmarks").touch()
    program = tmp_path / "bin/inverse_dynamics_benchmark"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\necho first >&2\necho ur10: no such robot >&2\nexit 1\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    with pytest.raises(
        Exception, match=r"benchmark: can't be run \(Permission denied\); build inv"
    ):
        measure()
    program.chmod(0o755)
    with pytest.raises(Exception, match="inverse_dynamics_benchmark failed: ur10: no such robot"):
        measure()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--repetitions", "0"), "--repetitions: expected a whole number above zero, got '0'"),
        (("--repetitions", "1"), "--repetitions: expected two or more, got '1'"),
        (("--repetitions", "1.5"), "expected a whole number above zero, got '1.5'"),
        (("--calls", "-1"), "--calls: expected a whole number above zero, got '-1'"),
        (("--seconds", "0"), "--seconds: expected a number above zero, got '0'"),
        (("--only", "("), "--only: expected a regular expression, got '('"),
        (("--from", "nothing.json"), "nothing.json: can't be read (No such file or directory)"),
        (("--plot", "speed.gif"), "speed.gif: expected a name that ends in .svg, .png or .pdf"),
        (
            ("--json", "a", "--plot", "./a"),
            "a: expected a file of its own for each result, got the same for --json and --plot; "
            "name another file with --plot",
        ),
        (("--update", "page.md"), "page.md: can't be read (No such file or directory); expected"),
        (("--update", "text"), "text: expected a part between `<!-- ids bench: NAME -->`"),
        (("--from", "a", "--only", "b"), "--only: expected no such choice beside --from"),
        (("--from", "a", "--latency"), "--latency: expected no such choice beside --from"),
        (("--from", "a", "--calls", "9"), "--calls: expected no such choice beside --from"),
        (("--from", "a", "--seconds", "1"), "--seconds: expected no such choice beside --from"),
        (
            ("--calls", "9"),
            "--calls: expected --latency beside it, got none; add --latency, or leave --calls out",
        ),
        (("--json", "text/a.json"), "text is not a directory); name another file with --json"),
    ],
)
def test_options_that_make_no_sense_are_told_before_anything_is_measured(
    ids, tmp_path, monkeypatch, arguments, expected
):
    monkeypatch.setattr("inverse_dynamics_benchmarks.measure", lambda **_: pytest.fail("measured"))
    (tmp_path / "text").write_text("by hand")
    fails(ids("bench", *arguments), expected)


@pytest.mark.parametrize(
    ("arguments", "calls"),
    [((), 0), (("--latency",), 1_000_000), (("--latency", "--calls", "9"), 9)],
)
def test_single_calls_are_timed_if_told(ids, speed_json, monkeypatch, arguments, calls):
    told = {}
    result = read_measurement(speed_json)
    monkeypatch.setattr("inverse_dynamics_benchmarks.measure", lambda **k: told.update(k) or result)
    assert ids("bench", *arguments)[0] == 0
    assert told["latency_calls"] == calls


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{", "expected JSON of `ids bench --json`: Expecting"),
        ("[]", "expected a result of `ids bench --json`, got something else"),
        ('{"context": {}}', "got something else (no 'benchmarks'); measure again"),
        (json.dumps(document()), "no entry with the aggregate_name 'min', and no latency"),
        (
            json.dumps(document(entry("a/b/c", 1.0, time_unit="ms"))),
            "time_unit: expected ns, got ms",
        ),
    ],
)
def test_a_file_that_is_no_measurement_is_told(ids, tmp_path, text, expected):
    (tmp_path / "a.json").write_text(text)
    fails(ids("bench", "--from", "a.json"), "ids: error: a.json: ", expected)


def test_what_exists_is_replaced_only_if_told(ids, speed_json):
    before = speed_json.read_text()
    command = ("bench", "--from", "speed.json", "--json", "speed.json")
    fails(ids(*command), "speed.json: exists already; name another file with --json", "--overwrite")
    assert speed_json.read_text() == before
    assert ids(*command, "--overwrite")[0] == 0
    assert read_measurement(speed_json).time("ur10", "torques", "ours") == 100.0


def test_times_are_of_one_state_and_by_the_right_clock(speed_json):
    result = read_measurement(speed_json)
    assert result.time("ur10", "torques", "ours") == 100.0
    assert result.time("ur10", "torques_batch", "ours") == 25.0
    assert result.time("ur10", "inertia", "ours") is None


def test_a_bound_takes_the_least_ratio_and_says_where(speed_json):
    found = {bound.what: bound for bound in bounds(read_measurement(speed_json))}
    torques = found["torques: UR10, Panda"]
    assert (torques.asked, torques.reached, torques.where) == (8.0, 7.0, "panda")
    assert not torques.holds
    batch = found["torques, batch: UR10, Panda"]
    assert (batch.asked, batch.reached, batch.holds) == (30.0, 36.0, True)
    kdl = found["every quantity, 1 to 30 joints"]
    assert (kdl.reached, kdl.where) == (15.0, "ur10, torques")
    assert found["forward dynamics"].reached is None
    assert not found["forward dynamics"].holds


def test_what_a_payload_costs_counts_from_a_solver_without_payloads():
    times = {"torques_fixed": 100.0, "torques": 101.0, "torques_payload": 107.0}
    entries = [entry(f"panda/{quantity}/ours", t) for quantity, t in times.items()]
    result = measurement(document(*entries), "here")
    found = {bound.what: bound for bound in bounds(result)}
    unset, carried = found["torques, payload not set"], found["torques, payload set"]
    assert (unset.reached, unset.where, unset.holds) == (pytest.approx(102 / 101), "panda", True)
    assert (carried.reached, carried.holds) == (pytest.approx(105 / 107), False)
    assert "2 ns more than without payloads | 1 | 1.01 (Panda) | yes |" in page(result)
    assert "| Panda | torques of a solver without payloads | 100 |" in page(result)


def test_an_update_of_an_observer_takes_half_a_microsecond_at_most():
    times = {
        "panda_feasible/momentum_observer": 400.0,
        "panda_identified/acceleration_residual": 625.0,
    }
    result = measurement(document(*(entry(f"{n}/ours", t) for n, t in times.items())), "here")
    found = {bound.what: bound for bound in bounds(result)}[
        "external torques, 7 joints, one update"
    ]
    assert (found.other, found.reached, found.holds) == ("0.5 µs", 0.8, False)
    assert "| Panda, identified | residual of inverse dynamics | 625 |" in page(result)
    assert "0.5 µs | 1 | 0.8 (Panda, identified, residual of inverse dynamics) | **no** |" in page(
        result
    )


def test_what_was_not_measured_is_told_on_a_page(speed_json):
    result = read_measurement(speed_json)
    text = updated("<!-- ids bench: observers -->\n<!-- ids bench: end -->\n", result, "here")
    assert text == "<!-- ids bench: observers -->\nNot measured.\n<!-- ids bench: end -->\n"
    for what in (
        "Coriolis matrix",
        "Jacobian of the tip",
        "torques, payload set",
        "external torques",
    ):
        row = next(line for line in page(result).splitlines() if line.startswith(f"| {what}"))
        assert row.endswith("| not measured |  |"), row


def test_all_components_stand_beside_the_sum_of_three_calls():
    times = {"inertia": 400.0, "coriolis": 900.0, "gravity": 500.0}
    entries = [entry(f"ur10/{q}/pinocchio", t) for q, t in times.items()]
    result = measurement(document(*entries, entry("ur10/components/ours", 150.0)), "here")
    found = {bound.what: bound for bound in bounds(result)}
    assert found["components: UR10, Panda"].reached == 12.0


def test_functions_of_the_engine_are_compared_for_generated_chains_too():
    times = {("panda", "ours"): 100.0, ("mixed6", "ours"): 150.0}
    times |= {("panda", "pinocchio"): 900.0, ("mixed6", "pinocchio"): 600.0}
    entries = [entry(f"{robot}/derivatives/{library}", t) for (robot, library), t in times.items()]
    result = measurement(document(*entries), "here")
    derivatives = {bound.what: bound for bound in bounds(result)}["derivatives"]
    assert (derivatives.asked, derivatives.reached, derivatives.where) == (3.0, 4.0, "mixed6")
    assert "| 6 joints, 2 slide | derivatives of the torques | 150 | 600 | 4.0 |" in page(result)


def test_kinematics_are_compared_with_pinocchio():
    times = {"tip_jacobian/ours": 50.0, "tip_jacobian/pinocchio": 300.0}
    result = measurement(document(*(entry(f"ur10/{name}", t) for name, t in times.items())), "here")
    tip = {bound.what: bound for bound in bounds(result)}["Jacobian of the tip: UR10, Panda"]
    assert (tip.asked, tip.reached, tip.where) == (4.0, 6.0, "ur10")
    assert "| UR10 | Jacobian of the tip | 50 | 300 | 6.0 |" in page(result)


def test_tables_say_what_was_measured(speed_json):
    text = page(read_measurement(speed_json))
    assert "| UR10 | torques | 100 | 900 | 1500 |  | 9.0 |" in text
    assert "| UR10 | torques | 25.0 | 900 | 36.0 |" in text
    assert "| torques: UR10, Panda | Pinocchio | 8 | 7 (Panda) | **no** |" in text
    assert "| every quantity, 1 to 30 joints | KDL | 1 | 15 (UR10, torques) | yes |" in text
    assert "| UR10 | forward dynamics |" not in text
    assert "Abacus" in text


def test_bounds_that_were_not_measured_are_named(speed_json):
    text = PARTS["bounds"](read_measurement(speed_json))
    assert "| H: UR10, Panda | Pinocchio | 4 | not measured |  |\n" in text
    assert "| 5 | not measured (Panda, identified) |  |\n" in text
    assert "| torques, batch: two threads | one thread | 1.8 | not measured |  |\n" in text
    complete = PARTS["bounds"](read_measurement(DOCS / "speed.json"))
    assert set(re.findall(r"^\| (.*?) \|", text, re.M)) <= set(
        re.findall(r"^\| (.*?) \|", complete, re.M)
    )
    assert "not measured" not in complete


def test_without_any_bound_measured_there_is_no_table_of_them():
    result = measurement(document(entry("ur10/torques/ours", 1.0)), "here")
    assert PARTS["bounds"](result) == ""
    assert "how many times as fast as" not in page(result)


def test_bounds_name_chains_and_quantities_as_the_other_tables_do():
    entries = [entry("mixed1/inertia/ours", 50.0), entry("mixed1/inertia/kdl", 200.0)]
    text = page(measurement(document(*entries), "here"))
    assert "| every quantity, 1 to 30 joints | KDL | 1 | 4 (1 joint, H) | yes |" in text


def test_long_calls_are_in_units_that_can_be_read():
    figures = {"slowest_state": 150.2, "p50": 160.0, "p99": 4538.4, "p99.99": 24807.0, "max": 2.4e7}
    counts = {"interruptions_per_second": 88.6, "context_switches": 9, "page_faults": 0}
    row = {"name": "ur10/torques/ours", "calls": 20_000, **figures, **counts}
    result = measurement({**document(), "latency": [row]}, "here")
    expected = "| 150 ns | 160 ns | 4538 ns | 24.8 µs | 24 ms | 89 | 9 | 0 |"
    assert f"| UR10, torques | this library {expected}" in page(result)
    assert "20 000 of each call.\n\n| call |" in page(result)


def test_a_build_without_optimisation_is_told():
    result = measurement(document(entry("ur10/torques/ours", 1.0), optimized="no"), "here")
    assert "**Compiled without optimisation: these times say nothing.**" in page(result)


def test_libraries_that_are_missing_are_told():
    result = measurement(document(entry("ur10/torques/ours", 1.0), kdl="1.5.1"), "here")
    text = page(result)
    assert "KDL 1.5.1" in text
    assert "Not found when the benchmarks were built: Pinocchio, MuJoCo." in text


def test_only_marked_parts_of_a_page_change(ids, speed_json, tmp_path):
    file = tmp_path / "page.md"
    file.write_text("by hand\n<!-- ids bench: calls -->\nold\n<!-- ids bench: end -->\nthe end\n")
    assert ids("bench", "--from", speed_json, "--update", "page.md")[0] == 0
    text = file.read_text()
    assert text.startswith("by hand\n<!-- ids bench: calls -->\n| robot |")
    assert text.endswith("|\n<!-- ids bench: end -->\nthe end\n")
    assert "old" not in text

    file.write_text("nothing")
    command = ("bench", "--from", speed_json, "--update", "page.md")
    fails(ids(*command), "page.md: expected a part between `<!-- ids bench: NAME -->`")
    file.write_text("<!-- ids bench: call -->\n<!-- ids bench: end -->")
    fails(ids(*command), "page.md: part 'call': expected one of machine, calls,")


def test_a_measurement_has_the_figures_of_its_file(tmp_path):
    result = measurement(document(entry("ur10/torques/ours", 1265.4999)), "here")
    write_measurement(result, tmp_path / "speed.json")
    assert read_measurement(tmp_path / "speed.json").times == result.times


def test_a_figure_is_the_same_for_the_same_figures(ids, speed_json, tmp_path):
    for name in ("a.svg", "b.svg"):
        assert ids("bench", "--from", speed_json, "--plot", name)[0] == 0
    svg = (tmp_path / "a.svg").read_bytes()
    assert svg == (tmp_path / "b.svg").read_bytes()
    assert b"this library" in svg
    assert b"900" in svg


@pytest.mark.parametrize("name", PAGES)
def test_pages_say_what_the_measurement_beside_them_says(name):
    text = (DOCS / name).read_text(encoding="utf-8")
    result = read_measurement(DOCS / "speed.json")
    remedy = f"ids bench --from docs/speed.json --update docs/{name}"
    assert updated(text, result, name) == text, remedy


def test_every_part_is_on_one_of_the_pages():
    text = "".join((DOCS / name).read_text(encoding="utf-8") for name in PAGES)
    assert sorted(re.findall(r"<!-- ids bench: (\w+) -->", text)) == sorted(
        [*PARTS, *["end"] * len(PARTS)]
    )


def test_the_measurement_names_neither_machine_nor_date():
    text = (DOCS / "speed.json").read_text(encoding="utf-8")
    assert not {"date", "host_name", "executable"} & set(json.loads(text)["context"])
    assert os.path.expanduser("~") + "/" not in text


def test_generated_code_counts_by_the_better_of_its_expressions():
    times = {"ours": 70.0, "casadi_templates": 140.0, "casadi_textbook": 105.0}
    entries = [entry(f"ur10/torques/{library}", t) for library, t in times.items()]
    result = measurement(document(*entries), "here")
    torques = {bound.what: bound for bound in bounds(result)}["torques, one state: UR10, Panda"]
    assert (torques.other, torques.asked, torques.reached) == ("C generated by CasADi", 1.43, 1.5)
    assert "| UR10 | torques | 70 | 140 | 105 | 0.67 |" in page(result)


def test_batches_of_the_engine_stand_beside_single_calls():
    times = {"forward_dynamics_batch/ours": 100.0, "forward_dynamics/pinocchio": 1800.0}
    entries = [entry(f"panda/{name}", t) for name, t in times.items()]
    result = measurement(document(*entries, entry("panda/gram_batch/ours", 600.0)), "here")
    batch = {b.what: b for b in bounds(result)}["forward dynamics, batch: UR10, Panda"]
    assert (batch.asked, batch.reached) == (15.0, 18.0)
    assert "| Panda | forward dynamics | 100 | 1800 | 18.0 |" in page(result)
    assert "| Panda | Gram matrices of the regressor | 600 |  |  |" in page(result)
