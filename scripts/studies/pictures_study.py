# SPDX-License-Identifier: Apache-2.0
"""Makes pictures of README.md and docs/ again.

./scripts/study pictures report|why
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from inverse_dynamics.public_recordings.public_recordings import data_directory

if TYPE_CHECKING:
    from collections.abc import Iterator

    from PIL.Image import Image
    from selenium.webdriver import Chrome

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs/pictures"

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-background-networking", "--force-prefers-reduced-motion", "--hide-scrollbars",
)  # fmt: skip
WIDTH, HEIGHT = 1240, 800  # of the browser's window, in its pixels
SHOWN_WIDTH = 860  # of the GIF
FRAMES, FRAME_TIME = 56, 120  # ms


def make_report() -> None:
    """The page of the model identified on a real UR10, from its own player."""
    from PIL import Image

    bag = data_directory() / "bags/ur10_exciting_trajectory"
    with tempfile.TemporaryDirectory() as scratch:
        robot = Path(scratch) / "ur10.yaml"
        command = ["ids", "identify", str(bag), "--robot", "ur10_real", "--out", str(robot)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        frames = list(_frames(robot.with_suffix(".html"), Path(scratch) / "profile"))
    colours = frames[len(frames) // 2].quantize(96)
    frames = [frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    first, *rest = frames
    file, time = PICTURES / "report.gif", FRAME_TIME
    first.save(file, save_all=True, append_images=rest, duration=time, loop=0, optimize=True)


def _frames(html: Path, profile: Path) -> Iterator[Image]:
    """The player at instants of equal distance, to the end."""
    from PIL import Image

    driver = _browser(profile)
    try:
        driver.get(html.as_uri())
        driver.execute_script(
            "document.querySelector('nav').remove();"
            "document.documentElement.style.scrollPadding = 0;"
            "document.querySelector('#run-1 .robot').scrollIntoView(true);"
        )
        for k in range(FRAMES):
            driver.execute_script(
                "const slider = document.querySelector('#run-1 .scrub');"
                "const low = Number(slider.min), high = Number(slider.max);"
                "slider.value = low + arguments[0] * (high - low);"
                "slider.dispatchEvent(new Event('input'));",
                k / (FRAMES - 1),
            )
            frame = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
            height = round(frame.height * SHOWN_WIDTH / frame.width)
            yield frame.resize((SHOWN_WIDTH, height), Image.Resampling.LANCZOS)
    finally:
        driver.quit()


def _browser(profile: Path) -> Chrome:
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or "chromium"
    for flag in (*FLAGS, f"--window-size={WIDTH},{HEIGHT}", f"--user-data-dir={profile}"):
        options.add_argument(flag)
    service = webdriver.ChromeService(executable_path=shutil.which("chromedriver"))
    return webdriver.Chrome(options=options, service=service)


def make_why() -> None:
    """What the page's own commands give; its results stay in out/why."""
    page = (ROOT / "docs/why_dont_my_torques_match.md").read_text(encoding="utf-8")
    shutil.rmtree(ROOT / "out/why", ignore_errors=True)
    for file in re.finditer(r"`(\w+\.xml)`:\n\n```xml\n(.*?)```", page, re.DOTALL):
        (ROOT / file[1]).write_text(file[2])  # the page's commands read it from here
    for block in re.finditer(r"^```bash\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        code = block[1].replace("ids evaluate ", "ids evaluate --figures none ")
        command = ["bash", "-euo", "pipefail", "-c", code]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    (ROOT / "payload.xml").unlink(missing_ok=True)
    subprocess.run(
        [sys.executable, PICTURES / "make_why_pictures.py", ROOT / "out/why", PICTURES], check=True
    )


if __name__ == "__main__":
    {"report": make_report, "why": make_why}[sys.argv[1]]()
