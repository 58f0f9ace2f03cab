# SPDX-License-Identifier: Apache-2.0
"""Small pictures of a page's plots and robots, to be compared with those in test/pictures.

    python report_pictures.py        # makes them again, in an environment that runs the tests

No text is in them and their elements have fixed sizes, so that fonts don't matter.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from inverse_dynamics.evaluation.evaluation import joint_errors
from inverse_dynamics.figures.scene import scene_from_urdf
from inverse_dynamics.report.page import Band, ReportRun, render_page
from inverse_dynamics.robot.descriptions import read_description
from inverse_dynamics.robot.robots import load_robot

PICTURES = Path(__file__).resolve().parent / "pictures"
ELEMENTS = {
    "torques": "[data-joint='1'] .plot:first-child canvas",
    "error": "[data-joint='1'] .plot:last-child canvas",
    "robot": ".robot canvas",
}
FIXED = (
    ".plot { width: 480px !important; height: 160px !important; }"
    ".robot { width: 400px !important; border: 0 !important; border-radius: 0 !important; }"
    ".robot canvas { width: 400px !important; height: 400px !important; }"
)


def run_of(title: str, urdf: str, count: int = 8000) -> ReportRun:
    """A run of the UR10 whose torques are curves with known noise."""
    joints = load_robot("ur10_simulated").joints or tuple(
        f"{name}_joint"
        for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    )
    t = np.linspace(0.0, 8.0, count)
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
        links=scene_from_urdf(urdf, joints),
        left_out=[(0.0, 0.3), (5.0, 5.0)],
        bands=[Band(0.0, 8.0, np.full(len(joints), 4.0))],
        others={"another model": computed + 6.0},
    )


def page() -> str:
    """A page of the UR10 with its shapes, and of its skeleton."""
    urdf = load_robot("ur10_simulated").urdf
    assert urdf is not None
    text = read_description(urdf)
    bare = text.replace("<visual", "<unknown").replace("</visual", "</unknown")
    return render_page("Pictures", [run_of("Shapes", text), run_of("Skeleton", bare)])


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


def open_page(driver, uri: str) -> None:
    """The page with elements of fixed sizes, and no text."""
    driver.get(uri)
    driver.execute_script(
        "CanvasRenderingContext2D.prototype.fillText = () => {};"
        "const style = document.createElement('style'); style.textContent = arguments[0];"
        "document.head.append(style);",
        FIXED,
    )


def take(driver, scheme: str, only: str = "") -> dict[str, np.ndarray]:
    """The pictures of an open page by name, (rows, columns, 3) of 0 to 255, an eighth as large as on the screen.

    only: the name of the one that is wanted.
    """
    set_screen(driver, 1400, 900, scheme)
    two_frames_later(driver)
    driver.execute_script(
        "document.querySelector('#run-1 .show-all').click();"
        "document.querySelectorAll('.reset-view').forEach((b) => b.click());"
    )
    paper = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    found = {}
    for run, elements in (("run-1", ELEMENTS), ("run-2", {"robot": ELEMENTS["robot"]})):
        for name, selector in elements.items():
            title = f"{'skeleton' if run == 'run-2' else name}_{scheme}"
            if only in ("", title):
                data = driver.execute_script(_DRAWN, f"#{run} {selector}", paper)
                found[title] = _small(data)
    return found


_DRAWN = """
const canvas = document.querySelector(arguments[0]);
const copy = document.createElement("canvas");
[copy.width, copy.height] = [canvas.width, canvas.height];
const context = copy.getContext("2d");
context.fillStyle = arguments[1];
context.fillRect(0, 0, copy.width, copy.height);
context.drawImage(canvas, 0, 0);
return [copy.toDataURL(), canvas.clientWidth, canvas.clientHeight];
"""


def _small(data) -> np.ndarray:
    import base64

    text, width, height = data
    image = Image.open(io.BytesIO(base64.b64decode(text.partition(",")[2]))).convert("RGB")
    return np.asarray(image.resize((width // 8, height // 8), Image.Resampling.BOX))


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Mean over the colours of what is drawn in either, 0 to 255; infinite for another size."""
    if a.shape != b.shape:
        return np.inf
    a, b = a.astype(float), b.astype(float)
    ground = np.median(b, axis=(0, 1))
    drawn = (np.abs(a - ground).max(axis=2) > 20) | (np.abs(b - ground).max(axis=2) > 20)
    return float(np.abs(a - b)[drawn].mean()) if drawn.any() else 0.0


def main() -> None:
    from test_report import browser

    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "page.html"
        file.write_text(page(), encoding="utf-8")
        with browser(Path(directory) / "profile") as driver:
            open_page(driver, file.as_uri())
            pictures = take(driver, "light") | take(driver, "dark")
    PICTURES.mkdir(exist_ok=True)
    for name, picture in pictures.items():
        Image.fromarray(picture).save(PICTURES / f"{name}.png", optimize=True)
        print(PICTURES / f"{name}.png", picture.shape)


if __name__ == "__main__":
    sys.exit(main())
