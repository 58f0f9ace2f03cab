# SPDX-License-Identifier: Apache-2.0
"""Pages of the package: what is in them, and as a browser shows them."""

import json
import re
import shutil
import time
from contextlib import contextmanager

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader",
    "--webgl-antialiasing-mode=none",  # draws the robot in a third of the time
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--force-prefers-reduced-motion",  # scrolling is then immediate
    "--window-size=1400,1300",
)


def data_of(html):
    text = re.search(r'<script type="application/json" id="runs">(.*?)</script>', html, re.DOTALL)
    return json.loads(text[1])


@contextmanager
def browser(profile, *flags):
    if not (CHROMIUM and DRIVER):
        pytest.skip("no Chromium here: install the packages chromium and chromium-driver")
    webdriver = pytest.importorskip("selenium.webdriver")
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={profile}", *flags):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.ChromeService(executable_path=DRIVER)
    driver = webdriver.Chrome(options=options, service=service)
    try:
        yield driver
    finally:
        driver.quit()


def press(driver, key):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.keys import Keys

    named = {"Home": Keys.HOME, "Left": Keys.ARROW_LEFT, "Right": Keys.ARROW_RIGHT}
    ActionChains(driver).send_keys(named.get(key, key)).perform()


def child(section, selector):
    from selenium.webdriver.common.by import By

    return section.find_element(By.CSS_SELECTOR, selector)


def time_of(section):
    return float(section.get_attribute("data-time"))


def play_slowly(driver, section):
    """So that a busy machine, which looks at the page late, still finds it playing."""
    slow = "arguments[0].add(new Option('slow', '0.1')); arguments[0].value = '0.1';"
    driver.execute_script(slow, child(section, ".speed"))


def wait_until(condition, what, seconds=20.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {seconds} s"
        time.sleep(0.03)


def complaints(driver):
    return [entry for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "ERROR")]
