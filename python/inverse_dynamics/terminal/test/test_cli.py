# SPDX-License-Identifier: Apache-2.0
import json
import os
import re
import shutil
import subprocess
from dataclasses import replace

import pytest
from command_line import fails
from example_recordings import recording
from example_robots import RIGID_BODY, UR10, URDF

from inverse_dynamics import Solver, cli, evaluate, read_evaluation
from inverse_dynamics.errors import BagError
from inverse_dynamics.recordings.bags import write_joint_logs
from inverse_dynamics.robots.robots import load_robot, robot_of_description
from inverse_dynamics.terminal.screen import _ProgressLines, announce, progress_bar, rounded

RAW = ("--accelerations", "backward-difference")
NO_FIGURE = ("--figures", "none")


def test_evaluate_prints_errors_and_writes_results(ids, bag, tmp_path):
    code, out, err = ids("evaluate", bag, "--robot", "ur10_simulated", "--out", "result")
    assert (code, err) == (0, "")
    assert re.search(r"joint +unit +MAE +RMSE +NRMSE \[%\] +bias +R²", out)
    assert re.search(r"elbow_joint +N m( +[-.e\d]+){5} *$", out, re.MULTILINE)
    assert re.search(r"mean +N m", out)
    assert "cut-off" in out
    assert re.search(r"page +result/report.html\nfigure +result/torques.png\n", out)
    assert "elbow_joint" in (tmp_path / "result/report.html").read_text()
    result = read_evaluation(tmp_path / "result")
    assert re.search(rf"mean +N m .*{re.escape(rounded(result.mean_rmse))}", out)
    remedy = "it has no metadata.yaml; a recording is in it: give result/bag\n"
    fails(ids("evaluate", "result", "--robot", "ur10_simulated"), remedy)
    metrics = json.loads((tmp_path / "result/metrics.json").read_text())
    assert [j["joint"] for j in metrics["joints"]] == list(result.joint_names)


def test_figures_have_the_formats_that_are_asked_for(ids, bag, tmp_path):
    evaluate = ("evaluate", bag, "--robot", "ur10_simulated", *RAW, "--out", "out", "--overwrite")
    for formats in ("png,svg,pdf", "svg", "none"):
        code, out, _ = ids(*evaluate, "--figures", formats)
        files = [f"torques.{f}" for f in formats.split(",") if f != "none"]
        assert code == 0
        assert re.findall(r"figure +out/(.*)", out) == files
        assert {file.name for file in (tmp_path / "out").glob("torques.*")} == set(files)


@pytest.mark.parametrize("formats", ["", "gif", "png,", "png,none", "png,png", "PNG"])
def test_other_formats_are_refused(ids, bag, formats):
    fails(
        ids("evaluate", bag, "--robot", "ur10_simulated", "--figures", formats),
        f"argument --figures: expected some of png, svg, pdf, such as png,pdf, or none, got '{formats}'",
    )


def test_a_folder_of_recordings_names_them_all(tmp_path):
    for name in ("b", "a"):
        (tmp_path / "bags" / name).mkdir(parents=True)
        (tmp_path / "bags" / name / "metadata.yaml").touch()
    with pytest.raises(BagError, match="recordings are in it: give one of .*bags/a, .*bags/b"):
        evaluate(tmp_path / "bags", "ur10_real")


def test_results_go_beside_where_one_is_if_nothing_is_said(ids, bag, tmp_path):
    code, _, _ = ids("evaluate", bag, "--robot", "ur10_simulated", *RAW, *NO_FIGURE)
    assert code == 0
    assert (tmp_path / "motion_ur10_simulated" / "metrics.json").is_file()


def test_every_override_reaches_the_evaluation(ids, tmp_path):
    log = recording(tmp_path / "bag", Solver(UR10), topic="/arm")
    urdf = shutil.copy(URDF, tmp_path / "arm.urdf")
    renamed = tuple(f"arm_{name}" for name in log.joint_names)
    log = replace(log, joint_names=renamed, storage="mcap")
    write_joint_logs(tmp_path / "renamed", {"/arm": log})
    arguments = ["--plugin", RIGID_BODY, "--no-friction", "--urdf", urdf, "--root", "base_link"]
    arguments += ["--tip", "wrist_3_link", "--gravity", "-1,2,-9", "--topic", "/arm"]
    arguments += ["--joints", ",".join(renamed), "--accelerations", "low-pass", "--cutoff", "7"]
    arguments += [
        "--clock",
        "receive",
        "--without-rule",
        "repeated",
        "--storage",
        "mcap",
        *NO_FIGURE,
    ]
    code, _, err = ids("evaluate", "renamed", "--robot", "ur10_real", "--out", "out", *arguments)
    assert (code, err) == (0, "")
    result = read_evaluation("out")
    robot = result.robot
    assert (robot.plugin, robot.friction, str(robot.urdf)) == (RIGID_BODY, False, str(urdf))
    assert (robot.root, robot.tip, robot.topic) == ("base_link", "wrist_3_link", "/arm")
    assert robot.gravity == (-1.0, 2.0, -9.0)
    assert robot.joints == renamed
    assert (result.accelerations.cutoff, result.log.clock) == (7.0, "receive")
    assert (tmp_path / "out/bag/bag.mcap").is_file()


def test_the_data_are_asked_what_efforts_mean(ids, tmp_path):
    ur10 = Solver(UR10)
    log = recording(tmp_path / "torques", ur10)
    currents = replace(log, effort=log.effort / ur10.drive_gains)
    write_joint_logs(tmp_path / "currents", {log.topic: currents})
    command = ("evaluate", "currents", "--robot", "ur10_real", "--out", "out", *NO_FIGURE)
    code, out, _ = ids(*command, "--effort-is", "auto")
    assert code == 0
    assert re.search(r"^effort means +current, found from the data, .*; sure: curr", out, re.M)
    assert re.search(r"torque is [\d.e+]+ % of the range off", out)
    metrics = json.loads((tmp_path / "out/metrics.json").read_text())
    assert metrics["effort"]["verdict"]["sure"] is True
    assert read_evaluation("out").effort.meaning == "current"


def test_a_description_alone_is_enough(ids, bag, tmp_path):
    alone = ("evaluate", bag, "--urdf", URDF, "--tip", "tool0", *RAW, *NO_FIGURE, "--out", "alone")
    code, out, err = ids(*alone)
    assert (code, err) == (0, "")
    assert f"solver         {RIGID_BODY}" in out
    given = ("evaluate", bag, "--robot", "ur10_simulated", *RAW, *NO_FIGURE, "--out", "given")
    assert ids(*given)[0] == 0
    alone, given = read_evaluation("alone"), read_evaluation("given")
    assert alone.robot.name == URDF.stem
    assert alone.mean_rmse == pytest.approx(given.mean_rmse, rel=1e-9)
    many = ("evaluate", bag, "--urdf", URDF, "--tip", "tool0", "--jobs", "1", "--out", "many")
    assert ids(*many, *NO_FIGURE)[0] == 0
    for verb in ("evaluate", "contact", "torques", "payload"):
        out = () if verb in ("evaluate", "contact") else ("--out", "x")
        fails(
            ids(verb, bag, *out), "expected --robot NAME or --urdf FILE, got neither; `ids robots`"
        )


def test_a_lone_topic_of_another_name_is_taken_and_reported(ids, tmp_path):
    recording(tmp_path / "bag", Solver(UR10), topic="/arm/joint_states")
    command = ("evaluate", "bag", "--robot", "ur10_real", *RAW, *NO_FIGURE)
    code, out, err = ids(*command, "--out", "out")
    assert (code, err) == (0, "")
    said = "bag has no topic /joint_states: its only one of joint states is /arm/joint_states"
    assert f"note           {said}\n" in out
    code, out, _ = ids(*command, "--topic", "/arm/joint_states", "--out", "named")
    assert code == 0
    assert said not in out


def test_an_earlier_result_is_replaced_and_said(ids, bag, tmp_path):
    command = ("evaluate", bag, "--robot", "ur10_simulated", "--out", "out", *RAW, *NO_FIGURE)
    assert ids(*command)[0] == 0
    before = (tmp_path / "out/series.npz").stat().st_mtime_ns
    code, _, err = ids(*command)
    assert (code, err) == (0, "ids: replaced the earlier result in out\n")
    after = (tmp_path / "out/series.npz").stat().st_mtime_ns
    assert after != before
    (tmp_path / "out/mine.txt").write_text("mine")
    fails(
        ids(*command),
        "ids: error: out: won't be overwritten: it holds 1 file that this command doesn't",
    )
    assert (tmp_path / "out/series.npz").stat().st_mtime_ns == after


def test_mistakes_of_the_user_are_told_and_nothing_is_written(ids, bag, tmp_path):
    robot = ("--robot", "ur10_simulated")
    fails(ids("evaluate", "nothing", *robot), "nothing: no such file or directory")
    fails(ids("evaluate", bag, "--robot", "ur11"), "robot 'ur11': expected one of", "ur10_real")
    fails(ids("evaluate", bag, *robot, "--plugin", "a/B"), "'a/B': not found: expected one of")
    fails(ids("evaluate", bag, *robot, "--topic", "/x"), "has no topic /x", "/joint_states")
    fails(ids("evaluate", bag, *robot, "--joints", "a,b"), "expected 6 names", "got 2 (a, b)")
    fails(ids("evaluate", bag, *robot, "--tip", "hand"), "hand")
    fails(ids("evaluate", bag, *robot, "--urdf", "arm.urdf"), "arm.urdf: no such file")
    fails(ids("evaluate", bag, *robot, *RAW, "--cutoff", "5"), "has no cut-off, got 5 Hz")
    (tmp_path / "file").touch()
    fails(ids("evaluate", bag, *robot, "--out", "file"), "file: exists and isn't a directory")
    fails(ids("evaluate", bag, *robot, *RAW, "--out", "file/x"), "file/x: can't be written")
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize(
    ("option", "link", "expected"),
    [
        ("--tip", "tool1", "tool1"),
        ("--root", "floor", "floor"),
        (
            "--tip",
            "forearm_link",
            "expected the 6 joints of its own model between them, got 3: sho",
        ),
    ],
)
def test_a_link_that_the_solver_does_not_use_is_checked_nevertheless(
    ids, tmp_path, option, link, expected
):
    recording(tmp_path / "bag", Solver(UR10))
    command = ("evaluate", "bag", "--robot", "ur10_real", *RAW, *NO_FIGURE)
    fails(ids(*command, option, link, "--out", "out"), "ids: error: robot ur10_real", expected)
    assert ids(*command, "--tip", "wrist_3_link")[0] == 0


def test_links_that_nothing_can_check_are_refused(ids, tmp_path):
    lines = ["schema: 1", "name: arm", "description: an arm", f"plugin: {UR10}", "tip: tool1"]
    (tmp_path / "arm.yaml").write_text("\n".join(lines))
    fails(ids("robots", "arm.yaml"), "robot arm: tip: expected none", "brings its own model")


ARM = f"""\
schema: 1
name: arm
description: an arm
plugin: {RIGID_BODY}
urdf: {URDF}
tip: tool0
joints: [shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, wrist_2_joint, w3]
"""


@pytest.mark.parametrize(
    ("line", "changed", "expected"),
    [
        ("tip: tool0", "tip: tol", ("robot arm", "tol")),
        ("tip: tool0", "tip: forearm_link", ("arm.yaml: joints: expected 3 names", "got 6")),
        (RIGID_BODY, "a/B", ("'a/B': not found",)),
        ("tip: tool0", "drive_gains: [1, 2]", ("arm.yaml: drive_gains: expected 6 numbers",)),
        (str(URDF), "arm.yaml", ("arm.yaml", "expected a URDF")),
        (
            "tip: tool0",
            "parameters: {batch_threads: no}",
            ("robot arm: parameter 'batch_threads'",),
        ),
        (
            "tip: tool0",
            "simulation: {gains: {elbow: {p: 1}}}",
            (":6: simulation.gains.elbow: unk",),
        ),
        ("tip: tool0", "simulation: {rate: 7}", (":6: simulation.rate: expected one of 125",)),
    ],
)
def test_a_run_configuration_is_checked_as_far_as_it_goes(ids, tmp_path, line, changed, expected):
    (tmp_path / "arm.yaml").write_text(ARM.replace(line, changed))
    fails(ids("robots", "arm.yaml"), *expected)


def test_a_joint_that_the_chain_lacks_is_told(ids, tmp_path):
    (tmp_path / "arm.yaml").write_text(ARM)
    code, out, err = ids("robots", "arm.yaml")
    assert (code, err) == (0, "")
    assert re.search(r"^chain +shoulder_pan_joint, .*, wrist_3_joint$", out, re.M)
    assert "w3 is not a joint of the chain: recordings must use this name" in out
    (tmp_path / "arm.yaml").write_text(ARM.replace("w3", "wrist_3_joint"))
    assert "is not a joint of the chain" not in ids("robots", "arm.yaml")[1]


@pytest.mark.parametrize("name", ["ur10_real", "panda_real", "ur10_simulated", "panda_simulated"])
def test_the_projects_robots_pass_the_check(ids, name):
    code, out, err = ids("robots", name)
    assert (code, err) == (0, "")
    assert re.search(r"^chain +.*(wrist_3_joint|fer_joint7)$", out, re.M)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("torque",), "invalid choice: 'torque'"),
        (("simulate", "--out", "b"), "the following arguments are required: --robot"),
        (("evaluate", "bag", "--robot", "x", "--gravity", "1,2"), "expected three numbers, x,y,z"),
        (
            ("evaluate", "bag", "--robot", "x", "--gravity", "1,2,1e999"),
            "expected three numbers, x",
        ),
        (
            ("evaluate", "bag", "--robot", "x", "--gravity", "0,0,-9_81"),
            "expected three numbers, x",
        ),
        (
            ("evaluate", "bag", "--robot", "x", "--gravity", "0,0,１"),
            "expected three numbers, x,y,z",
        ),
        (("evaluate", "bag", "--robot", "x", "--cutoff", "1_0"), "expected a number above zero"),
        (("evaluate", "bag", "--robot", "x", "--cutoff", "-1"), "expected a number above zero"),
        (("evaluate", "bag", "--robot", "x", "--joints", "a,,b"), "expected names, a,b,c"),
        (("evaluate", "bag", "--robot", "x", "--accelerations", "best"), "choose from"),
        (("evaluate", "bag", "--robot", "x", "--effort-is", "force"), "invalid choice: 'force'"),
    ],
)
def test_options_that_make_no_sense_are_told(ids, arguments, expected):
    fails(ids(*arguments), expected)


@pytest.mark.parametrize("terminal", [True, False])
def test_names_are_whole_on_a_narrow_terminal_and_in_a_pipe(ids, bag, monkeypatch, terminal):
    if terminal:
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("TERM", "dumb")  # 80 columns, nothing bold
    monkeypatch.setenv("COLUMNS", "80")
    shutil.copytree(bag, "another_recording")
    evaluated = ("evaluate", bag, "another_recording", "--robot", "ur10_simulated", *RAW)
    code, out, _ = ids(*evaluated, *NO_FIGURE, "--jobs", "1", "--out", "out")
    names = ("another_recording", *Solver(UR10).joint_names)
    assert code == 0
    assert [name for name in names if name not in out] == []
    code, shown, _ = ids("robots", "ur10_real")
    assert code == 0
    assert [name for name in names[1:] if shown.count(name) < 2] == []  # chain and joints
    table = [line for line in out.splitlines() if re.search(r"recording|motion|joint", line)]
    if terminal:
        assert max(map(len, table)) <= 80
    else:
        header, *rows = (re.split("  +", line.strip()) for line in table if " " in line)
        header, *rows = [row for row in (header, *rows) if len(row) == 8]
        assert header == ["recording", *names[1:], "mean"]
        assert [row[0] for row in rows] == ["motion", "another_recording"]


def test_a_new_robots_friction_is_told_as_it_is_written(ids, tmp_path):
    for option, told, written in (
        ((), "yes, but the model states none", "friction: true"),
        (("--no-friction",), "left out", "friction: false"),
    ):
        code, out, _ = ids("robots", "--new", "new.yaml", "--overwrite", "--urdf", URDF, *option)
        assert code == 0
        assert re.search(rf"^friction +{told}$", out, re.MULTILINE)
        assert written in (tmp_path / "new.yaml").read_text()


def test_results_stand_before_what_is_said_of_them(bag, tmp_path):
    """Where standard output and error are one pipe."""
    command = ["ids", "evaluate", bag, "--robot", "ur10_simulated", *RAW, *NO_FIGURE, "--json"]
    for _ in range(2):
        result = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path, check=True
        )  # fmt: skip
    assert result.stdout.endswith("}\nids: replaced the earlier result in motion_ur10_simulated\n")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("evalute",), "did you mean evaluate?; see `ids --help`\n"),
        (
            ("evaluate", "bag", "--robot", "x", "--accelerations", "lowpass"),
            "did you mean low-pass?; see `ids evaluate --help`\n",
        ),
        (
            ("evaluate", "bag", "--robot", "x", "--gravty", "0,0,1"),
            "unrecognized arguments: --gravty 0,0,1; did you mean --gravity?; see `ids evaluate --help`\n",
        ),
        (("robots", "--list", "x"), "unrecognized arguments: --list; see `ids robots --help`\n"),
        (("report", "a", "--ou=b"), None),
        (
            ("--vision",),
            "unrecognized arguments: --vision; did you mean --version?; see `ids --help`\n",
        ),
        (("-v", "robots"), "unrecognized arguments: -v; see `ids --help`\n"),
        (("completion",), "are required: shell; see `ids completion --help`\n"),
    ],
)
def test_what_is_like_something_known_is_proposed_and_the_right_help_named(
    ids, arguments, expected
):
    code, _, err = ids(*arguments)
    assert code == 2
    assert err.count("\n") == 1
    assert expected is None or err.endswith(expected)


def test_without_a_verb_the_help_is_shown(ids):
    code, out, err = ids()
    assert (code, out) == (2, "")
    assert err.startswith("usage: ids VERB ...")
    assert "start here:" in err


def test_robots_shows_one(ids):
    code, out, _ = ids("robots", "panda_real")
    assert code == 0
    for part in ("panda_real", "franka_inria_inverse_dynamics_solver/", "fer_joint7", "Gaz"):
        assert part in out
    assert re.search(r"^urdf +/\S+/urdf/panda\.urdf$", out, re.MULTILINE)  # can be copied
    fails(ids("robots", "ur11"), "expected one of")


def test_help_is_a_verb_too(ids):
    assert ids("help") == ids("--help")
    assert ids("help", "robots") == ids("robots", "--help")


def test_a_description_is_a_robot_too(ids, bag, tmp_path):
    assert load_robot(URDF) == robot_of_description(URDF)
    fails(
        ids("evaluate", bag, "--robot", "arm.urdf"),
        "arm.urdf: no such file; expected a robot description",
    )
    fails(
        ids("evaluate", bag, "--robot", "arm.urdf.xacro"),
        "--robot arm.urdf.xacro: expected a run configuration or a URDF, got a .xacro file; give it as --urdf",
    )
    (tmp_path / "empty.urdf").write_text(" \n")
    fails(ids("evaluate", bag, "--urdf", "empty.urdf"), "empty.urdf: is empty; expected a URDF")
    (tmp_path / "log.csv").write_text("time,position.a\n0,1\n")
    fails(
        ids("evaluate", bag, "--urdf", "log.csv"),
        "log.csv: isn't XML; expected a URDF, got 'time,position.a\\n0,1'",
    )


def test_a_verb_whose_package_is_not_built_names_the_remedy(ids, monkeypatch):
    monkeypatch.setitem(cli.BUILT_ON_REQUEST, "bench", "package_that_is_not_built")
    build = "`./scripts/build --packages-select package_that_is_not_built` in the workspace, then "
    for options in ((), ("--help",), ("--only", "ur10/torques")):
        fails(
            ids("bench", *options),
            "ids: error: verb bench: package package_that_is_not_built: not in any sourced workspace, "
            f"as it is built only on request: {build}`source install/local_setup.bash`; see",
        )
    assert "bench" not in ids("--help")[1]


def test_the_installed_command_runs_without_a_virtual_environment(bag, tmp_path):
    command = shutil.which("ids")
    assert command is not None
    environment = {k: v for k, v in os.environ.items() if k != "VIRTUAL_ENV"}
    environment["PATH"] = "/usr/bin:/bin"
    arguments = ["evaluate", bag, "--robot", "ur10_simulated", "--out", tmp_path / "out", *RAW]
    result = subprocess.run(
        [command, *arguments], capture_output=True, text=True, check=False, env=environment
    )
    assert result.returncode == 0, result.stderr
    assert "elbow_joint" in result.stdout
    arguments = ["evaluate", tmp_path / "nothing", "--robot", "ur10_simulated"]
    result = subprocess.run(
        [command, *arguments], capture_output=True, text=True, check=False, env=environment
    )
    assert result.returncode == 2
    assert result.stderr.startswith("ids: error: ")


def test_without_a_sourced_workspace_the_command_names_the_remedy():
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    result = subprocess.run(
        [shutil.which("ids")], capture_output=True, text=True, check=False, env=environment
    )
    assert result.returncode != 0
    assert "source install/local_setup.bash" in result.stderr


def test_long_work_is_reported_where_standard_error_is_no_terminal(capsys, monkeypatch):
    monkeypatch.setattr("inverse_dynamics.terminal.screen._FIRST_LINE", 10.0)
    seconds = iter([0.0, 5.0, 11.0, 12.0, 25.0, 60.0])
    lines = _ProgressLines(lambda: next(seconds))
    for done in (1, 2, 3, 4, 10):
        lines("reading", done, 10)
    assert capsys.readouterr().err == (
        "ids: reading: 20 % done after 11 s ...\nids: reading: 40 % done after 25 s ...\n"
    )


def test_progress_tells_the_time_that_is_left(monkeypatch, capsys):
    """Where standard error is a terminal."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("TERM", "xterm")
    with progress_bar() as progress:
        progress("reading", 0, 1000)
        progress("reading", 10, 1000)
        announce("the next step")
    plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", capsys.readouterr().err)
    assert re.search(r"reading .* 10/1000 \d:\d\d:\d\d [-\d]+:[-\d:]+ left", plain), plain
    assert re.search(r"[\r\n]ids: the next step \.\.\. *\n", plain), plain  # bars stay below it
