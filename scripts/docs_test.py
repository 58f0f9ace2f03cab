# SPDX-License-Identifier: Apache-2.0
"""Pages without a generator: links, anchors, navigation; and the hooks of the site's build."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from docs_hooks import LINK, ROOT, beyond_docs

DOCS = ROOT / "docs"
PAGES = sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md")])
PICTURES = DOCS / "pictures"
PICTURE = re.compile(r"!\[[^\]]*\]\(([^()\s]+)\)")


def without_code(page: Path) -> str:
    """The page without fenced blocks and code within lines."""
    text = re.sub(r"^ *```.*?^ *```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(page: Path) -> set[str]:
    """Anchors that GitHub and the site make of the headings."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in plain}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings(page: Path) -> None:
    text = without_code(page)
    targets = [match[2] for match in LINK.finditer(text)] + PICTURE.findall(text)
    for target in targets:
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), f"{target}: no such file"
        if anchor and file.suffix == ".md":
            assert anchor in anchors(file), f"{target}: no such heading"


def test_every_picture_is_shown() -> None:
    shown = {
        Path(p).name for page in PAGES for p in PICTURE.findall(page.read_text(encoding="utf-8"))
    }
    assert {f.name for f in PICTURES.iterdir() if f.suffix in {".png", ".gif", ".svg"}} <= shown


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")[1]
    named = re.findall(r": (\S+\.md)$", navigation, re.M)
    assert sorted(named) == [str(page.relative_to(DOCS)) for page in sorted(DOCS.rglob("*.md"))]


def test_what_pages_tell_people_to_run_is_run() -> None:
    lists = [ROOT / ".ci/run", ROOT / "scripts/released", *(ROOT / ".github/workflows").iterdir()]
    run = "\n".join(file.read_text(encoding="utf-8") for file in lists)
    run += "lint_license study_field study_gallery study_transfer"  # part of lint; need clones of others' repositories
    for page in set(PAGES) - {ROOT / "CHANGELOG.md"}:
        text = page.read_text(encoding="utf-8")
        for command in re.findall(r"(?:^ *|`)\./scripts/(\w+(?: [a-z]\w*)?)", text, re.M):
            name, _, what = command.partition(" ")
            found = re.search(rf"\b{name}(\b|_)", run) and re.search(rf"\b({name}_)?{what}\b", run)
            assert found, f"{page}: nothing runs ./scripts/{command}"


def test_links_beyond_the_pages_lead_into_the_repository_or_are_text() -> None:
    text = "[design](design.md), [a `header`](../README.md#x)\n```\n[no](../gone)\n```\n![p](pictures/p.png)\n"
    without = text.replace("[a `header`](../README.md#x)", "a `header`")
    assert beyond_docs(text, "control.md") == without
    linked = text.replace("../README.md#x", "https://example.org/r/blob/main/README.md")
    assert beyond_docs(text, "control.md", "https://example.org/r") == linked
    assert beyond_docs("[l](../../LICENSE)", "api/cpp.md") == "l"
    header = "../../core/chain_dynamics/include/chain_dynamics/fast_model.hpp"
    page = '<a href="../cpp/fast__model_8hpp.html">l</a>'  # of Doxygen
    assert beyond_docs(f"[l]({header})", "api/cpp.md", "https://example.org/r") == page


def test_a_link_to_nothing_is_an_error() -> None:
    with pytest.raises(FileNotFoundError, match=r"docs/a.md: link to gone.md, which doesn't exist"):
        beyond_docs("[l](../gone.md)", "a.md")
