# SPDX-License-Identifier: Apache-2.0
"""Makes pictures of README.md and docs/. Called by ./scripts/pictures."""

from __future__ import annotations

import argparse
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from PIL.Image import Image
    from selenium.webdriver import Chrome

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/pictures"

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-background-networking", "--force-prefers-reduced-motion", "--hide-scrollbars",
)  # fmt: skip
WIDTH, HEIGHT = 1240, 800  # of the browser's window, in its pixels
SHOWN_WIDTH = 860  # of the GIF
FRAMES, FRAME_TIME = 56, 120  # ms


# ---- The page in motion ----------------------------------------------------------------------------------------------


def make_report() -> None:
    """The page of a real UR10, from its own player."""
    from PIL import Image

    data = os.environ.get("IDS_DATA_DIR")
    if not data:
        sys.exit(
            "error: report: IDS_DATA_DIR isn't set; it names the directory with the recordings of `ids data`"
        )
    with tempfile.TemporaryDirectory() as scratch:
        bag = Path(data) / "bags/ur10_exciting_trajectory"
        result, html = Path(scratch) / "Real UR10", Path(scratch) / "report.html"
        _ids(
            "evaluate", str(bag), "--robot", "ur10_real", "--figures", "none", "--out", str(result)
        )
        _ids("report", str(result), "--title", "Real UR10", "--out", str(html))
        frames = list(_frames(html, Path(scratch) / "profile"))
    colours = frames[len(frames) // 2].quantize(96)
    frames = [frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames]
    frames[0].save(
        PICTURES / "report.gif",
        save_all=True,
        append_images=frames[1:],
        duration=FRAME_TIME,
        loop=0,
        optimize=True,
    )


def _frames(html: Path, profile: Path) -> Iterator[Image]:
    """The player at instants of equal distance, to the end."""
    from PIL import Image

    driver = _browser(profile)
    try:
        driver.get(html.as_uri())
        driver.execute_script("document.querySelector('.run .stage').scrollIntoView(true);")
        for k in range(FRAMES):
            driver.execute_script(
                "const slider = document.querySelector('.run .scrub');"
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

    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    driver = shutil.which("chromedriver")
    if not (chromium and driver):
        sys.exit(
            "error: report: no Chromium here; ./scripts/setup installs chromium and chromium-driver"
        )
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in (*FLAGS, f"--window-size={WIDTH},{HEIGHT}", f"--user-data-dir={profile}"):
        options.add_argument(flag)
    return webdriver.Chrome(
        options=options, service=webdriver.ChromeService(executable_path=driver)
    )


# ---- The page of mistakes --------------------------------------------------------------------------------------------


def make_why() -> None:
    """What the page's own commands give; its results stay in out/why."""
    page = (ROOT / "docs/why_dont_my_torques_match.md").read_text(encoding="utf-8")
    shutil.rmtree(ROOT / "out/why", ignore_errors=True)
    for file in re.finditer(r"`(\w+\.xml)`:\n\n```xml\n(.*?)```", page, re.DOTALL):
        (ROOT / file[1]).write_text(file[2])  # the page's commands read it from here
    for block in re.finditer(r"^```(bash|python)\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        command = {"bash": ["bash", "-euo", "pipefail", "-c"], "python": [sys.executable, "-c"]}[
            block[1]
        ]
        code = block[2].replace("ids evaluate ", "ids evaluate --figures none ")
        subprocess.run([*command, code], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    (ROOT / "payload.xml").unlink(missing_ok=True)
    subprocess.run(
        [sys.executable, PICTURES / "make_why_pictures.py", ROOT / "out/why", PICTURES], check=True
    )


def _ids(*arguments: str) -> None:
    subprocess.run(["ids", *arguments], check=True, stdout=subprocess.DEVNULL)


MAKE: dict[str, Callable[[], None]] = {"report": make_report, "why": make_why}


def main() -> None:
    """Make pictures, one after the other."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"of {', '.join(MAKE)}; all by default"
    )
    given = parser.parse_args()
    unknown = set(given.names) - set(MAKE)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; known: {', '.join(MAKE)}")
    for name in given.names or MAKE:
        print(f"==> {name}", flush=True)
        MAKE[name]()


if __name__ == "__main__":
    main()
