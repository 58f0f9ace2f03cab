# SPDX-License-Identifier: Apache-2.0
"""Hooks of MkDocs: what the pages of docs/ need to be pages of a site, too.

Pages link to files beyond docs/, as on GitHub. On the site such a link leads to Doxygen's page of a header, to the
repository that DOCS_REPOSITORY_URL names, or is plain text.
"""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

ROOT = Path(__file__).resolve().parent.parent

# [text](target), not of a picture. Text may hold code and brackets of code.
LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)")
FENCE = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)


def doxygen_link(text: str, page: str, header: Path) -> str:
    """HTML, since MkDocs would report a Markdown link to a page that Doxygen writes later as broken."""
    # Doxygen names its page after the file, or after its path where two files have that name.
    rooms = ("core", "solvers", "methods", "ros2")
    unique = sum(len([*(ROOT / r).glob(f"*/include/**/{header.name}")]) for r in rooms) == 1
    name = header.name if unique else str(header)
    file = name.replace("_", "__").replace("/", "_2").replace(".", "_8")
    return f'<a href="{"../" * page.count("/")}cpp/{file}.html">{text}</a>'


def beyond_docs(text: str, page: str, repository: str = "") -> str:
    """The page with its links to files beyond docs/ made links into the repository, or plain text."""

    def replaced(match: re.Match[str]) -> str:
        text, target = match[1], match[2]
        if target.startswith("#") or "://" in target:
            return match[0]
        path = posixpath.normpath(
            posixpath.join("docs", posixpath.dirname(page), target.split("#")[0])
        )
        if path.startswith("docs/"):
            return match[0]
        if not (ROOT / path).exists():
            raise FileNotFoundError(f"docs/{page}: link to {path}, which doesn't exist")
        if "/include/" in path and path.endswith(".hpp"):
            return doxygen_link(text, page, Path(path))
        return f"[{text}]({repository}/blob/main/{path})" if repository else text

    parts, end = [], 0
    for fence in FENCE.finditer(text):
        parts += [LINK.sub(replaced, text[end : fence.start()]), fence[0]]
        end = fence.end()
    return "".join([*parts, LINK.sub(replaced, text[end:])])


def on_page_markdown(markdown: str, *, page: Any, **_: Mapping[str, Any]) -> str:
    """Called by MkDocs for each page."""
    repository = os.environ.get("DOCS_REPOSITORY_URL", "").rstrip("/")
    return beyond_docs(markdown, page.file.src_uri, repository)


def on_page_content(html: str, *, page: Any, **_: Mapping[str, Any]) -> str:
    """Called by MkDocs for each page in HTML: drawings need a script."""
    script = "../" * page.url.count("/") + "assets/javascripts/mermaid.js"
    return html + f'<script src="{script}"></script>' if 'class="mermaid"' in html else html
