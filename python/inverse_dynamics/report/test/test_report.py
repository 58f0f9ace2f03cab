# SPDX-License-Identifier: Apache-2.0
import base64
import json
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from example_recordings import (
    motion,
    points_of_motion,
    table_of,
    trajectory,
    write_table,
    write_trajectories,
)
from example_robots import JOINTS
from pages import (
    CHROMIUM,
    FLAGS,
    browser,
    child,
    complaints,
    data_of,
    press,
    time_of,
    wait_until,
)

from inverse_dynamics import cli, evaluate, read_evaluation, write_evaluation
from inverse_dynamics._core import Effort, Verdict
from inverse_dynamics.comparison.comparison import compare
from inverse_dynamics.errors import UserError
from inverse_dynamics.evaluation.page import report_run
from inverse_dynamics.show.page import (
    MAX_SAMPLES,
    Band,
    ReportSummary,
    render_page,
)
from inverse_dynamics.show.tables import ReportTable


@pytest.fixture(scope="module")
def evaluation(bag):
    return evaluate(bag, "ur10_simulated", accelerations="low-pass", cutoff=2.0)


@pytest.fixture(scope="module")
def comparison(evaluation):
    other = replace(evaluation, computed=evaluation.computed + 1.0)
    return compare([evaluation, other], ("as it is", "one N m off"))


@pytest.fixture(scope="module")
def run(evaluation):
    """What a page shows of the evaluation."""
    return report_run(evaluation, "first")


@pytest.fixture(scope="module")
def page(run, comparison, tmp_path_factory):
    """The page as a file: two runs and a comparison."""
    file = tmp_path_factory.mktemp("page") / "report.html"
    runs = [run, _with_others(replace(run, title="second")), comparison.report_run("third")]
    file.write_text(render_page("A page", runs, ["A note."]))
    return file


def _with_others(run):
    """The same with another model's torques to choose, and bands."""
    time, half = run.time, np.arange(1.0, 7.0)
    return replace(
        run,
        others={"other model": run.computed + 5.0},
        bands=[Band(time[0], time[700], half), Band(time[700], time[-1], 2 * half)],
    )


def plots_of(run, joint):
    """Torques and errors of a joint: the plot, with its series by name."""
    return [
        {**plot, "series": {series["name"]: series for series in plot["series"]}}
        for plot in run["plots"][2 * joint : 2 * joint + 2]
    ]


def floats(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


# ---- the page as text ------------------------------------------------------------------------------------------------


def test_page_needs_no_network(page):
    html = page.read_text()
    fetches = re.findall(r"""(?:src|href|action|poster|data|srcset)\s*=\s*["']([^"']*)""", html)
    fetches += re.findall(r"url\(\s*[\"']?([^)\"']*)", html)
    assert fetches
    assert {f for f in fetches if not f.startswith(("#", "data:"))} == set()
    for word in ("@import", "fetch(", "XMLHttpRequest", "WebSocket", "<iframe", "<object"):
        assert word not in html


def test_series_come_through_in_single_precision(page, evaluation):
    run = data_of(page.read_text())[0]
    assert [plot["label"] for plot in run["plots"][::2]] == list(evaluation.joint_names)
    (motion,) = run["motions"]
    np.testing.assert_array_equal(floats(motion["time"]), evaluation.time.astype("f4"))
    q = [floats(column) for column in motion["q"]]
    np.testing.assert_array_equal(q, evaluation.log.q.T.astype("f4"))
    for j in range(6):
        torques, errors = plots_of(run, j)
        series = {**torques["series"], **errors["series"]}
        measured, computed = evaluation.measured[:, j], evaluation.computed[:, j]
        expected = {"measured": measured, "computed": computed, "error": computed - measured}
        for name, values in expected.items():
            assert "time" not in series[name]
            assert ("limit" in series[name]) == (name == "error")
            np.testing.assert_array_equal(floats(series[name]["values"]), values.astype("f4"))


def test_long_recordings_keep_their_peaks(evaluation, run):
    count = 3 * MAX_SAMPLES + 17
    t = np.linspace(0.0, 60.0, count)
    q, measured = np.sin(t)[:, None], np.cos(t)[:, None]
    computed = measured.copy()
    computed[12_346] += 50.0  # one sample each: every third would miss one of them
    computed[20_003] -= 70.0
    long = replace(
        run, time=t, q=q, measured=measured, computed=computed, table=evaluation.errors[:1]
    )
    html = render_page("Long", [long])
    torques, errors = (plot["series"] for plot in plots_of(data_of(html)[0], 0))
    values, times = (floats(torques["computed"][key]) for key in ("values", "time"))
    assert len(values) == len(times) <= MAX_SAMPLES
    assert np.all(np.diff(times) > 0)
    assert (times[0], times[-1]) == (0.0, 60.0)
    assert values.max() == np.float32(computed.max())
    assert values.min() == np.float32(computed.min())
    assert floats(errors["error"]["values"]).min() == pytest.approx(-70.0)
    assert f"at most {MAX_SAMPLES:,} of them" in html


def test_names_are_text_and_never_markup(evaluation, comparison):
    evil = "</script><script>alert(1)</script>"
    errors = tuple(replace(error, joint=evil, unit=evil) for error in evaluation.errors)
    robot = replace(evaluation.robot, description=evil, source=evil)
    bad = replace(evaluation, errors=errors, robot=robot, notes=(evil,), joint_names=(evil,) * 6)
    bad_comparison = replace(comparison, labels=(evil, evil + "2"), evaluations=(bad, bad))
    html = render_page(evil, [report_run(bad, evil), bad_comparison.report_run("third")], [evil])
    assert "<script>alert" not in html
    assert html.count("</script") == 2
    assert data_of(html)[0]["plots"][0]["label"] == evil


def test_what_efforts_mean_and_how_sure_that_is_stands_among_the_assumptions(evaluation, run):
    stated = dict(run.assumptions)
    assert stated["effort means"] == "torque, as the run configuration says"
    verdict = Verdict("current", sure=True, summary="current is 1 % of the range off")
    found = Effort("current", "found from the data", (2.0,) * 6, verdict)
    page = render_page("A page", [report_run(replace(evaluation, effort=found))])
    assert "current, found from the data, with drive gains 2 2 2 2 2 2 N m/A; sure: " in page
    assert verdict.summary in page


def test_tables_and_trajectories_are_shown_as_recordings_are(tmp_path, torques):
    write_table(tmp_path / "motion.csv", table_of(torques, motion()[2]))
    plan = trajectory(JOINTS, points_of_motion(effort=torques))
    write_trajectories(tmp_path / "plan", [plan])
    for name, topic in (("motion.csv", ""), ("plan", ", /planned")):
        result = evaluate(tmp_path / name, "ur10_simulated")
        write_evaluation(result, tmp_path / f"{name}_run", figures=())
        run = report_run(read_evaluation(tmp_path / f"{name}_run"))
        stated = dict(run.assumptions)
        assert run.recording == f"{name}{topic}, 1500 samples, 6.0 s"
        assert stated["accelerations"] == "given by the recording"
        assert len(run.links) > 6
        page = render_page("A page", [run])
        series = plots_of(data_of(page)[0], 1)[0]["series"]
        expected = pytest.approx(torques[:, 1], rel=1e-6)
        assert floats(series["measured"]["values"]) == expected
        assert floats(series["computed"]["values"]) == expected


def test_a_comparison_is_one_run_with_the_others_to_choose_and_a_table(page, comparison):
    html = page.read_text()
    torques, errors = (plot["series"] for plot in plots_of(data_of(html)[2], 1))
    assert list(torques) == ["measured", "one N m off", "as it is"]
    assert torques["one N m off"]["hidden"] is False
    own, other = (floats(errors[name]["values"]) for name in ("error", "one N m off"))
    np.testing.assert_allclose(other, own + 1, atol=1e-4)
    table = html[html.index("RMSE of each joint") :].replace("<wbr>", "")
    row = re.findall(r">([^<>]*)</t[dh]>", table[table.index(">elbow_joint<") :])[:4]
    assert row[1] == "N m"
    assert [float(c) for c in row[2:]] == pytest.approx(comparison.rmse[:, 2], rel=0.01)


def test_a_start_transient_does_not_flatten_the_plot_of_errors(run):
    """Nor does a spike; what was left out doesn't count."""
    t = run.time
    smooth = 0.5 * np.sin(3 * t)[:, None] * np.ones(6)
    wild = smooth + 90.0 * (t < t[0] + 0.5)[:, None]
    wild[700] = 200.0
    shown = replace(run, computed=wild, measured=0 * wild, left_out=[(t[0], t[0] + 0.5)])
    error = plots_of(data_of(render_page("A page", [shown]))[0], 2)[1]["series"]["error"]
    assert 0.5 <= error["limit"] < 0.8
    assert floats(error["values"]).max() == 200.0


def test_report_verb_writes_the_page(evaluation, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_evaluation(evaluation, tmp_path / "result", figures=())
    assert cli.main(["report", "result", "--labels", "arm"]) == 0
    assert capsys.readouterr().out == "report.html\n"
    html = (tmp_path / "report.html").read_text()
    assert "<title>arm</title>" in html
    assert html.count(">arm<") == 2  # title and headline
    assert cli.main(["report", "result"]) == 2
    assert "exists already" in capsys.readouterr().err


def test_bands_and_other_models_are_in_the_data(page, evaluation):
    first, second, _ = data_of(page.read_text())
    torques, errors = plots_of(first, 0)
    assert (list(torques["series"]), list(errors["series"])) == (
        ["measured", "computed"],
        ["error"],
    )
    assert torques["band"] == errors["band"] == []
    torques, errors = plots_of(second, 1)
    assert [part["half"] for part in torques["band"]] == [2.0, 4.0]
    assert torques["band"][0]["to"] == pytest.approx(evaluation.time[700] - evaluation.time[0])
    assert torques["series"]["other model"]["hidden"] is True
    own, other = (floats(errors["series"][name]["values"]) for name in ("error", "other model"))
    np.testing.assert_allclose(other, own + 5.0, atol=1e-4)


def test_a_summary_comes_before_the_runs(run):
    table = ReportTable("Errors", ("joint", "error"), [("elbow", 0.12345), ("mean", float("nan"))])
    more = ReportTable("More <of it>", ("x",), [(1e-9,)], note="A note.")
    below = ReportTable("Thresholds", ("joint", "limit"), [("elbow", 2.0)])
    summary = ReportSummary(table, "Choices", [("law", "step")], ["Found"], [more], [below])
    html = render_page("A page", [run], summary=summary)
    assert html.index("<h2>Errors</h2>") < html.index('id="run-1"') < html.index("Choices</h2>")
    for text in (
        ">0.123</td>",
        ">\u2013</td>",
        "<dd>step</dd>",
        "<li>Found</li>",
        "1.00·10⁻⁹",
    ):
        assert text in html
    assert "<summary>More &lt;of it&gt;</summary>" in html
    assert html.index("<h2>Errors</h2>") < html.index("<h3>Thresholds</h3>") < html.index("run-1-")


def in_order(html, *texts):
    """Whether the page has each text, and in this order."""
    body = html[html.index("<body>") :].replace("<wbr>", "")
    places = [body.find(text) for text in texts]
    return -1 not in places and places == sorted(places)


def test_robot_recording_verdict_table_and_plots_come_in_this_order(run):
    found = replace(run, cause="wrist_1_joint is reversed", notes=("a note",))
    html = render_page(run.title, [found])
    link = '<a href="#run-1-joint-4">Likely cause of the error</a>'
    order = (
        "<h1>first</h1>",
        run.description,
        run.recording,
        "mean RMSE",
        link,
        "Errors of each joint",
    )
    assert in_order(
        html, *order, 'id="run-1-joint-1"', 'id="run-1-joint-4"', "What was assumed", "H(q)"
    )
    assert html.count(">first<") == 2  # title and headline
    html = render_page(run.title, [replace(found, cause="friction")])
    worst = max(run.table, key=lambda row: row.nrmse)
    place = f"#run-1-joint-{[*run.table].index(worst) + 1}"
    assert f'<a href="{place}">Likely cause of the error</a>' in html
    assert f'<a href="{place}">{worst.joint}</a>' in html


def test_a_comparison_comes_first_on_its_page(comparison):
    robot = replace(comparison.evaluations[1].robot, friction=True)
    other = replace(comparison.evaluations[1], robot=robot)
    html = replace(comparison, evaluations=(comparison.evaluations[0], other)).page()
    assert in_order(
        html,
        "<h1>ur10_simulated: 2 runs compared</h1>",
        "Recording",
        ">one N m off</th>",
        'id="run-1',
    )
    assert "mean NRMSE" not in html  # cards of one run
    assert "<summary>RMSE" not in html
    facts = html[html.index('id="choices"') :].replace("<wbr>", "")
    assert "<dt>friction, as it is</dt><dd>left out</dd>" in facts
    assert "<dt>friction, one N m off</dt><dd>as the solver models it</dd>" in facts
    assert facts.count("<dt>gravity") == 1


# ---- the page in a browser -------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def opened(page, tmp_path_factory):
    with browser(tmp_path_factory.mktemp("profile")) as driver:
        driver.get(page.as_uri())
        yield driver


@pytest.fixture
def section(opened):
    """The first run, rewound, with the keyboard on the page."""
    from selenium.webdriver.common.by import By

    opened.execute_script("document.activeElement.blur(); window.scrollTo(0, 0);")
    found = opened.find_element(By.ID, "run-1")
    if child(found, ".play").text == "Pause":  # a test that failed has left it playing
        child(found, ".play").click()
        opened.execute_script("document.activeElement.blur();")
    press(opened, "Home")
    press(opened, "0")
    assert time_of(found) == 0.0
    return found


def pixels(driver, canvas):
    return driver.execute_script("return arguments[0].toDataURL();", canvas)


def test_browser_shows_robot_and_plots_without_complaints(opened, section):
    assert not child(section, ".no-webgl").is_displayed()
    robot = child(section, ".robot canvas")
    blank = opened.execute_script(
        "const c = document.createElement('canvas'); c.width = arguments[0].width;"
        "c.height = arguments[0].height; return c.toDataURL();",
        robot,
    )
    assert pixels(opened, robot) != blank
    ink = opened.execute_script(
        "return [...arguments[0].querySelectorAll('.plot-base')].map((c) => c.getContext('2d')"
        ".getImageData(0, 0, c.width, c.height).data.filter((v, i) => i % 4 === 3 && v > 0).length);",
        section,
    )
    assert len(ink) == 12
    assert min(ink) > 1000
    assert complaints(opened) == []


@pytest.mark.parametrize("pointer", ["mouse", "touch"])
def test_values_are_read_at_the_place_that_is_pointed_at(opened, section, pointer):
    """In every plot; a finger moves the robot there too."""
    read = """
        const seen = [], write = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function(text) { seen.push(text); };
        const plot = arguments[0].querySelector(".plot-overlay"), {width} = plot.getBoundingClientRect();
        const at = {pointerType: arguments[1], bubbles: true};
        const event = new PointerEvent("pointermove", at);
        Object.defineProperty(event, "offsetX", {value: 54 + 0.5 * (width - 64)});
        plot.dispatchEvent(event);
        CanvasRenderingContext2D.prototype.fillText = write;
        plot.dispatchEvent(new PointerEvent("pointerleave", at));
        return seen;
    """
    seen = opened.execute_script(read, section, pointer)
    assert float(seen[0].removesuffix(" s")) == pytest.approx(3.0, abs=0.02)
    assert len(seen) == 6 * (3 + 2)  # time, two torques; time, error
    assert float(seen[3 + 1]) == pytest.approx(float(seen[1]) - float(seen[2]), abs=2e-3)
    assert time_of(section) == pytest.approx(3.0 if pointer == "touch" else 0.0, abs=0.02)


def test_a_plot_says_that_it_is_cut(opened):
    """An axis of errors has a limit; one of torques shows each peak."""
    ask = """
        const plot = {options: {band: []}, shown: () => [{limit: arguments[0], values: [-200, 0.5]}]};
        Plot.prototype.setRange.call(plot);
        return [...plot.range, plot.cut];
    """
    low, high, cut = opened.execute_script(ask, 0.5)
    assert -low == high == pytest.approx(0.56)
    assert cut == ", cut: peak 200"
    low, high, cut = opened.execute_script(ask, None)
    assert low < -200
    assert cut == ""


def test_keys_step_zoom_and_reset(opened, section):
    plot = child(section, ".plot-base")
    whole = pixels(opened, plot)
    press(opened, "Right")
    assert time_of(section) == pytest.approx(0.1, abs=1e-3)
    press(opened, "Left")
    assert time_of(section) == 0.0
    press(opened, "+")
    zoomed = pixels(opened, plot)
    assert zoomed != whole
    press(opened, ">")
    assert pixels(opened, plot) not in (zoomed, whole)
    press(opened, "0")
    assert pixels(opened, plot) == whole
    assert complaints(opened) == []


def test_the_view_turns_and_resets(opened, section):
    robot = child(section, ".robot canvas")
    home = pixels(opened, robot)
    opened.execute_script("arguments[0].focus();", robot)
    press(opened, "Left")
    assert pixels(opened, robot) != home
    child(section, ".reset-view").click()
    assert pixels(opened, robot) == home


def test_a_page_of_a_browser_without_webgl_says_so_and_still_plots(page, tmp_path):
    with browser(tmp_path, "--disable-3d-apis") as driver:
        driver.get(page.as_uri())
        from selenium.webdriver.common.by import By

        section = driver.find_element(By.ID, "run-1")
        assert "offers no WebGL" in child(section, ".no-webgl").text
        plot = child(section, ".plot-base")
        whole = pixels(driver, plot)
        child(section, ".play").click()
        wait_until(lambda: time_of(section) > 0.05, "time of the player")
        child(section, ".play").click()
        press(driver, "+")
        ink = "return arguments[0].getContext('2d').getImageData(0, 0, 800, 300).data.some((v) => v > 0);"
        assert driver.execute_script(ink, plot)
        assert len(whole) > 2000
        assert complaints(driver) == []


def test_paper_shows_the_plots(page, tmp_path):
    pdftoppm = shutil.which("pdftoppm")
    if not (CHROMIUM and pdftoppm):
        pytest.skip("needs the packages chromium and poppler-utils, to print and to look at it")
    printed, profile = (
        f"--print-to-pdf={tmp_path / 'page.pdf'}",
        f"--user-data-dir={tmp_path}/profile",
    )
    command = [CHROMIUM, *FLAGS, profile, printed, "--virtual-time-budget=1000", page.as_uri()]
    subprocess.run(command, check=True, timeout=60, capture_output=True)
    subprocess.run([pdftoppm, "-r", "90", tmp_path / "page.pdf", tmp_path / "sheet"], check=True)
    from matplotlib.image import imread

    sheets = [imread(file) for file in sorted(tmp_path.glob("sheet*.ppm"))]
    vermilion = sum(
        int(np.sum((s[..., 0] > 180) & (s[..., 1] < 140) & (s[..., 2] < 80))) for s in sheets
    )
    assert vermilion > 600  # the curves of computed torques; the legends alone have fewer than 300


# ---- the demonstration -----------------------------------------------------------------------------------------------


def test_demo_shows_the_simulated_robots_and_how_to_get_the_others(tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("IDS_DATA_DIR", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    (tmp_path / "inverse_dynamics/bags").mkdir(
        parents=True
    )  # as `ids data` without network leaves it
    out = tmp_path / "demo"
    assert cli.main(["demo", "--quick", "--out", str(out)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "Panda, simulated" in printed
    assert printed.count("`ids data` fetches the recordings") == 1
    assert "UR10, real and Panda, real: left out" in printed
    assert "UR10, simulated kdl " in printed
    assert str(out / "report.html") in printed
    html = (out / "report.html").read_text()
    assert "Two robots" in html
    assert "there is no recording ur10_exciting_trajectory" in html
    matches = re.findall(r"computed and measured torques differ by (\S+) N m at most", html)
    assert len(matches) == 2
    assert all(0 < float(match) < 1e-6 for match in matches)
    assert (out / "ur10_simulated" / "torques.png").is_file()
    assert json.loads((out / "demo.json").read_text())["robots"]["panda_simulated"]["samples"] > 0
    (out / "mine.txt").write_text("mine")
    assert cli.main(["demo", "--quick", "--out", str(out)]) == 2
    assert "holds 1 file that this command doesn't write (mine.txt)" in capsys.readouterr().err


def test_demo_that_fails_leaves_nothing(tmp_path, monkeypatch):
    from inverse_dynamics.demo import demo

    def fails(*arguments, **options):
        raise UserError("no page today")

    monkeypatch.setattr("inverse_dynamics.show.page.write_page", fails)
    with pytest.raises(UserError, match="no page today"):
        demo.run_demo(tmp_path / "demo", quick=True)
    assert list(tmp_path.iterdir()) == []


def test_demo_wants_recordings_where_they_are_said_to_be(tmp_path, capsys, monkeypatch):
    assert cli.main(["demo", "--recordings", str(tmp_path), "--out", str(tmp_path / "demo")]) == 2
    assert "holds no recording ur10_exciting_trajectory" in capsys.readouterr().err
    monkeypatch.setenv("IDS_DATA_DIR", str(tmp_path))
    assert cli.main(["demo", "--out", str(tmp_path / "demo")]) == 2
    assert "IDS_DATA_DIR: expected a directory with recordings" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_browser_draws_another_model_when_it_is_chosen(opened):
    from selenium.webdriver.common.by import By

    run = opened.find_element(By.ID, "run-2")
    plot = child(run, '[data-joint="1"] .plot-base')
    box = child(run, ".legend input")
    before = pixels(opened, plot)
    opened.execute_script("arguments[0].click();", box)
    assert pixels(opened, plot) != before
    opened.execute_script("arguments[0].click();", box)
    assert pixels(opened, plot) == before
    assert complaints(opened) == []
