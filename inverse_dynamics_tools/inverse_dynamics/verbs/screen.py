# SPDX-License-Identifier: Apache-2.0
"""What is printed: names come from recordings and descriptions, and must not control the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from inverse_dynamics.base.wording import printable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import ConsoleOptions, RenderableType
    from rich.segment import Segment


class Screen(Console):
    """Standard output (or standard error): lines stay whole, control characters become escapes."""

    def __init__(
        self, *, stderr: bool = False, soft_wrap: bool = True, width: int | None = None
    ) -> None:
        super().__init__(
            stderr=stderr, soft_wrap=soft_wrap, width=width, highlight=False, markup=False
        )

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Every text passes here."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text))

    def on_broken_pipe(self) -> None:
        """The reader has gone: the command's own affair, see cli.py."""
        raise BrokenPipeError
