# SPDX-License-Identifier: Apache-2.0
"""The page as readers meet it: its lines, a phone, a dark screen, a keyboard, a screen reader."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from example_evaluations import summary
from pages import browser, child, play_slowly, press, time_of
from test_palette import contrast

from inverse_dynamics.evaluation.evaluation import joint_errors
from inverse_dynamics.evaluation.page_of_many import render_recordings_page
from inverse_dynamics.robots.robots import load_robot
from inverse_dynamics.show import palette
from inverse_dynamics.show.page import (
    Band,
    ReportRun,
    ReportSummary,
    render_page,
)
from inverse_dynamics.show.scene import scene_of
from inverse_dynamics.show.tables import ReportTable, aligned, joint_table

SCREENS = [(390, "light"), (390, "dark"), (1920, "dark"), (1300, "light")]


def run_of(title: str, text: str) -> ReportRun:
    """A run of the UR10 whose torques are curves with known noise."""
    joints = load_robot("ur10_simulated").joints or tuple(
        f"{name}_joint"
        for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    )
    t = np.linspace(0.0, 8.0, 8000)
    phase = np.arange(len(joints))
    q = np.stack([0.6 * np.sin(0.7 * t + k) - 0.5 * (k == 1) for k in phase], axis=1)
    noise = np.random.default_rng(1).normal(size=q.shape)
    smooth = 30.0 * np.stack([np.sin(1.3 * t + k) * np.exp(-0.1 * t) for k in phase], axis=1)
    measured, computed = smooth + 2.0 * noise, smooth + 1.5 * np.cos(3.0 * t)[:, None]
    units = ("N m",) * len(joints)
    return ReportRun(
        title=title,
        description="Curves with known noise",
        solver="rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody",
        time=t,
        q=q,
        measured=measured,
        computed=computed,
        table=joint_errors(joints, units, computed, measured),
        assumptions=[
            ("solver", "rigid_body_inverse_dynamics_solver/InverseDynamicsSolverRigidBody")
        ],
        links=scene_of(text, joints, Path()).links,
        left_out=[(0.0, 0.3), (5.0, 5.0)],
        bands=[Band(0.0, 8.0, np.full(len(joints), 4.0))],
        others={"another model": computed + 6.0},
    )


def set_screen(driver, width, height, scheme="light", **features):
    """A screen of that size [CSS pixels] of a reader who prefers that scheme."""
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    features = {"prefers-color-scheme": scheme, **features}
    listed = [{"name": name, "value": value} for name, value in features.items()]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": listed})


def two_frames_later(driver) -> None:
    """Waits until the page has drawn itself again in its present size and colours."""
    driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]));")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Files by name: each kind of page, with names as long as users have them."""
    urdf = load_robot("ur10_simulated").urdf.read_text()
    run = run_of("UR10, simulated", urdf)
    bare = run_of("second", urdf.replace("visual", "unknown"))
    run = replace(
        run,
        cause="the elbow is reversed",
        notes=("the first 300 samples are a start transient",),
        tables=[joint_table("The same without the 300 samples that are left out", run.table)],
        contacts=[(2.0, 2.5)],
    )
    names = [row.joint for row in run.table]
    headings = (
        "joint",
        "unit",
        "URDF",
        "present model",
        "refitted",
        "identified",
        "in 95 % band [%]",
    )
    table = ReportTable(
        "Held-out error", headings, [(name, "N m", 12.5, 2.26, 1.47, 1.08, 95.0) for name in names]
    )
    found = ReportSummary(
        table, "What was chosen, and why", [("law", "smooth_coulomb")], ["one finding"], [table]
    )
    summaries = [
        summary(f"a_recording_with_a_long_name_{k}", 1.0 + k, start=1_767_000_000.0)
        for k in range(5)
    ]
    texts = {
        "evaluation": render_page("An arm of a long name: measured and computed torques", [run]),
        "comparison": render_page("Two runs", [run, bare], ["A note."]),
        "identification": render_page("ur10_real: identified model", [run], summary=found),
        "recordings": render_recordings_page("A week", summaries, {"fourth": "gone"}, {}),
    }
    directory = tmp_path_factory.mktemp("pages")
    for name, text in texts.items():
        (directory / f"{name}.html").write_text(text, encoding="utf-8")
    return directory


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture
def show(driver, pages):
    """Shows a page by name on a screen of some size; opens it unless it is open."""

    def shown(name, width=1400, height=900, scheme="light"):
        set_screen(driver, width, height, scheme)
        uri = (pages / f"{name}.html").as_uri()
        if driver.current_url != uri:
            driver.get(uri)
        two_frames_later(driver)
        return driver

    return shown


@pytest.fixture(scope="module", params=["evaluation", "comparison", "identification", "recordings"])
def turn(request, driver, pages):
    """Shows a page, which is opened once and on a phone, on another screen."""

    def turned(width, scheme):
        set_screen(driver, width, 844, scheme)
        two_frames_later(driver)
        return driver

    set_screen(driver, 390, 844)
    driver.get((pages / f"{request.param}.html").as_uri())
    return turned


# ---- lines -----------------------------------------------------------------------------------------------------------


def test_numbers_of_a_column_are_written_alike():
    assert aligned([1.234, 0.01234, 250.0, float("nan"), 0.0, "text"]) == [
        "1.23\u2007\u2007",
        "0.0123",
        "250\u2008\u2007\u2007\u2007\u2007",
        "\u2013",
        "0\u2008\u2007\u2007\u2007\u2007",
        "text",
    ]
    assert aligned([0.9999, -2.0]) == ["1.00", "-2.00"]
    assert aligned([2.26, 5.25e-6, -0.000999]) == ["2.26", "5.25·10⁻⁶", "-9.99·10⁻⁴"]


# ---- screens ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [390, 1300, 1920])
def test_lines_break_between_words_and_parts_of_names(show, width):
    broken = show("evaluation", width).execute_script(
        r"""
        const lines = (node) => {
          const range = document.createRange();
          range.selectNodeContents(node);
          return new Set(Array.from(range.getClientRects(), (box) => box.top)).size;
        };
        return [...document.querySelectorAll("dd, th")].flatMap((cell) => [...cell.childNodes])
            .filter((node) => node.nodeType === Node.TEXT_NODE && !/\s/.test(node.data.trim()))
            .filter((node) => lines(node) > 1).map((node) => node.data);
        """
    )
    assert broken == []


def test_a_phone_shows_every_column(turn):
    driver = turn(390, "light")
    cut = driver.execute_script(
        "return [...document.querySelectorAll('.scroll')].filter((e) => e.scrollWidth > e.clientWidth)"
        ".map((e) => e.getAttribute('aria-label'))"
    )
    assert cut == []
    headings = driver.execute_script(
        "const of = (e) => getComputedStyle(e, '::before').content;"
        "return [...document.querySelectorAll('.wide tbody tr:first-child td')].map(of)"
    )
    assert headings
    assert "none" not in headings


def test_a_change_of_the_scheme_draws_plots_and_robot_again(show):
    driver = show("evaluation")
    corner = """
        const gl = document.querySelector(".robot canvas").getContext("webgl"), robot = new Uint8Array(4);
        gl.readPixels(2, gl.drawingBufferHeight - 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, robot);
        return [...robot].slice(0, 3);
    """
    light = driver.execute_script(corner)
    show("evaluation", scheme="dark")
    dark = driver.execute_script(corner)
    assert min(light) > 200
    assert max(dark) < 80
    assert driver.execute_script("return document.documentElement.dataset.drawn") == "dark"


@pytest.mark.parametrize(("width", "scheme"), SCREENS)
def test_nothing_is_wider_than_the_screen(turn, width, scheme):
    driver = turn(width, scheme)
    assert driver.execute_script("return innerWidth") == width
    assert driver.execute_script("return document.documentElement.scrollWidth") <= width
    too_far = driver.execute_script(
        "return [...document.querySelectorAll('body *')].filter((e) => !e.closest('.scroll, .hidden, .skip') &&"
        "e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.outerHTML.slice(0, 80))"
    )
    assert too_far == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_stand_out_from_what_is_behind_them(turn, scheme):
    driver = turn(1300, scheme)
    pairs = driver.execute_script(
        """
        const opaque = (color) => !/^rgba?\\(.*, 0\\)$|transparent/.test(color) && !color.startsWith("color(");
        const behind = (element) => {
          while (element) {
            const color = getComputedStyle(element).backgroundColor;
            if (opaque(color)) return color;
            element = element.parentElement;
          }
        };
        const found = new Map();
        for (const element of document.querySelectorAll("body *")) {
          const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
          if (!own || element.closest("script, .hidden, .skip, option, .cell, svg")) continue;
          const pair = [getComputedStyle(element).color, behind(element)];
          found.set(pair.join(), [...pair, element.outerHTML.slice(0, 80)]);
        }
        return [...found.values()];
        """
    )
    assert len(pairs) > 2

    def color(text):
        return "#" + "".join(f"{int(float(v)):02X}" for v in re.findall(r"[\d.]+", text)[:3])

    weak = [pair for pair in pairs if contrast(color(pair[0]), color(pair[1])) < 4.5]
    assert weak == []
    ground = color(driver.execute_script("return getComputedStyle(document.body).backgroundColor"))
    assert ground == (palette.LIGHT if scheme == "light" else palette.DARK)["paper"]


# ---- keyboard and screen reader --------------------------------------------------------------------------------------


def test_the_keyboard_reaches_everything_and_shows_where_it_is(show):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    driver = show("comparison")
    section = child(driver, "#run-1")
    reached = []
    for _ in range(24):
        ActionChains(driver).send_keys(Keys.TAB).perform()
        kind, outline = driver.execute_script(
            "const e = document.activeElement, style = getComputedStyle(e);"
            "return [e.className || e.tagName, style.outlineStyle === 'none' ? 0 : parseFloat(style.outlineWidth)]"
        )
        reached.append(kind)
        assert outline >= 2, kind
        if kind == "reset-view":
            break
    assert reached[0] == "skip"
    for control in ("play", "speed", "scrub", "show-all", "reset-view"):
        assert control in reached
    driver.execute_script("arguments[0].focus()", child(section, ".play"))
    press(driver, "Right")  # steps although a button has the focus
    assert time_of(section) == pytest.approx(0.1, abs=1e-3)
    play_slowly(driver, section)
    press(driver, " ")
    assert child(section, ".play").text == "Pause"
    press(driver, " ")
    assert child(section, ".play").text == "Play"
    slider = child(section, ".scrub")
    driver.execute_script("arguments[0].focus()", slider)
    press(driver, "Home")
    press(driver, "Right")
    assert time_of(section) == pytest.approx(0.1, abs=1e-3)
    assert slider.get_attribute("aria-valuetext") == "0.10 s of 8.00 s"


def test_a_screen_reader_finds_names_for_everything(turn):
    nameless = turn(1300, "light").execute_script(
        """
        const nameless = [];
        const note = (element) => nameless.push(element.outerHTML.slice(0, 80));
        document.querySelectorAll("table").forEach((table) => {
          if (!table.caption || !table.caption.textContent.trim()) note(table);
          if (table.querySelector("thead th:not([scope=col])")) note(table);
          table.querySelectorAll("tbody tr").forEach((row) => { if (!row.querySelector("th[scope=row]")) note(row); });
        });
        document.querySelectorAll("canvas").forEach((canvas) => {
          if (!canvas.getAttribute("aria-label") && !canvas.ariaHidden) note(canvas);
        });
        document.querySelectorAll("svg").forEach((svg) => {
          if (!svg.closest("[aria-hidden=true], [aria-label]")) note(svg);
        });
        document.querySelectorAll("button, select, input, nav").forEach((control) => {
          const label = control.getAttribute("aria-label") || control.textContent.trim() || control.closest("label");
          if (!label) note(control);
        });
        return nameless;
        """
    )
    assert nameless == []


# ---- robot -----------------------------------------------------------------------------------------------------------


def test_the_robot_fills_its_panel(show):
    """In the directions that limit it, the motion takes 94 % of the panel, and never more."""
    found = show("evaluation").execute_script(
        """
        const run = JSON.parse(document.getElementById("runs").textContent)[0];
        const time = decode(run.motions[0].time), q = run.motions[0].q.map(decode);
        const motion = Array.from({length: 30}, (_, k) => positionsAt(time, q, 8 * k / 29));
        const points = pointsOf(run.links, motion);
        const [azimuth, elevation, aspect] = [-0.9, 0.38, 1.1];
        const {target, distance} = fitted(points, azimuth, elevation, aspect);
        const eye = backwards(azimuth, elevation).map((share, i) => target[i] + distance * share);
        const all = perspective(kFieldOfView, aspect, 0.1, 50).multiply(lookAt(eye, target));
        return points.map((point) => {
          const {x, y, w} = all.transformPoint(new DOMPoint(...point));
          return [x / w, y / w];
        });
        """
    )
    low, high = np.min(found, axis=0), np.max(found, axis=0)
    assert (low >= -0.95).all()
    assert (high <= 0.95).all()
    assert max(high - low) > 1.7
