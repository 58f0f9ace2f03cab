# SPDX-License-Identifier: Apache-2.0
import re
from dataclasses import replace
from pathlib import Path

import pytest
from example_evaluations import summary
from pages import browser

from inverse_dynamics.evaluation.page_of_many import render_recordings_page


@pytest.fixture(scope="module")
def html():
    late = 1_767_000_000.0
    summaries = [
        summary("first", start=late),
        summary("second & <b>", 4.0, start=late - 3600.0),
        summary("third", 1.5, start=late + 3600.0, notes=("odd",)),
    ]
    links = {"first": "page.html", "second & <b>": "page.html"}
    return render_recordings_page("A week", summaries, {"fourth": "<i>gone</i>"}, links)


def test_names_and_messages_are_no_markup(html):
    assert 'href="second%20%26%20%3Cb%3E/page.html">second &amp; &lt;b&gt;</a>' in html
    assert "<dt>fourth</dt><dd>&lt;i&gt;gone&lt;/i&gt;</dd>" in html


def test_what_lies_above_the_median_is_shaded(html):
    rows = re.search(r"<tbody>(.*)</tbody>", html, re.DOTALL)[1].split("<tr ")[1:]
    shades = [re.findall(r"--shade: ([\d.]+)", row) for row in rows]
    assert shades[0] == []  # below the median, which is the third's
    assert shades[1] == ["0.89"] * 3  # log(4 / 1.5) / log(3)
    assert shades[2] == []


def test_the_start_is_shown_where_stamps_are_dates(html):
    assert '<td class="date" data-heading="start (UTC)">2025-12-29 09:20:00</td>' in html
    undated = render_recordings_page("A week", [summary("one"), summary("two")], {}, {})
    assert "start (UTC)" not in undated
    assert 'href="one/"' in undated


def test_notes_are_told_once_with_their_recordings(html):
    assert "<dt>first, second &amp; &lt;b&gt;</dt><dd>the first 5 of 400 samples" in html
    assert "<dt>third</dt><dd>odd</dd>" in html


def test_one_recording_without_errors_or_filter_is_shown():
    """No division by a median of zero, no empty columns."""
    one = summary("alone", 0.0)
    one = replace(one, accelerations=replace(one.accelerations, cutoff=None))
    page = render_recordings_page("One", [one], {}, {})
    assert "cut-off" not in page
    assert "--shade: " not in page


def test_the_order_can_be_chosen(html, tmp_path):
    from selenium.webdriver.common.by import By

    file = tmp_path / "report.html"
    file.write_text(html)
    with browser(tmp_path / "profile") as driver:
        driver.get(Path(file).as_uri())

        def names():
            cells = driver.find_elements(By.CSS_SELECTOR, ".heat tbody th")
            return [cell.text.split()[0] for cell in cells]

        orders = {
            "worst": ["second", "third", "first"],
            "start": ["second", "first", "third"],
            "given": ["first", "second", "third"],
        }
        for order, expected in orders.items():
            driver.find_element(By.CSS_SELECTOR, f"#order option[value={order}]").click()
            assert names() == expected
        wide = driver.execute_script("return document.documentElement.scrollWidth")
        assert wide <= driver.execute_script("return window.innerWidth")
