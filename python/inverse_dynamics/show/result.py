# SPDX-License-Identifier: Apache-2.0
"""What a feature gives back: numbers, lines for the screen, tables, a figure, a page, and the files of all that.

class Contacts(ResultDirectory):  # a frozen dataclass without a __repr__ of its own
    contents = files_of("contacts.json", "contacts", PAGE)
    numbers, lines, plot, page = contact_numbers, contact_lines, contact_figure, contact_page

find_contacts(...).save("contacts")
found = Contacts.load("contacts")
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, ClassVar, TypeVar

import numpy as np

from inverse_dynamics.errors import OutputError
from inverse_dynamics.outputs.files import (
    Contents,
    check_output_directory,
    check_output_file,
    files_written_whole,
    write_text,
    written_whole,
)
from inverse_dynamics.outputs.plain import json_text
from inverse_dynamics.outputs.stored import restored, stored
from inverse_dynamics.progress import no_progress
from inverse_dynamics.recordings.joint_log import check_storage
from inverse_dynamics.show.plots import FORMATS, check_formats, save_figure
from inverse_dynamics.show.tables import ReportTable
from inverse_dynamics.wording import told

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from typing import Any

    from matplotlib.figure import Figure
    from typing_extensions import Self

    from inverse_dynamics.progress import Progress
    from inverse_dynamics.recordings.joint_log import Storage

    Texts = str | Path | Iterable[object]
    # A table, or a key with its text or texts; the key of the title is "".
    Line = ReportTable | tuple[str, Texts]

T = TypeVar("T")
R = TypeVar("R")

PAGE = "report.html"
SERIES = "series.npz"
_SERIES_OF = "{stem}.npz"
_MOST_LINES, _LONGEST_LINE = 10, 110  # of repr()


class Result(ABC):
    """What a feature gives back."""

    plot: Callable[[], Figure]  # of matplotlib, where there is one; raises MissingPackageError
    page: Callable[[], str]  # HTML, complete in itself, where there is one
    notes: tuple[str, ...]  # in words, where there are any

    def __post_init__(self) -> None:
        if "notes" in vars(self):
            object.__setattr__(self, "notes", tuple(map(told, self.notes)))

    @abstractmethod
    def numbers(self) -> dict[str, Any]:
        """All but samples, for JSON."""

    @abstractmethod
    def lines(self) -> Iterable[Line]:
        """What the screen shows of it."""

    def inputs(self) -> Iterable[Path | None]:
        """Files that it was made of, which must not be overwritten."""
        return ()

    def __repr__(self) -> str:
        lines = [type(self).__name__]
        for line in texts_of(self.lines()):
            key, text = ("table", line.title) if isinstance(line, ReportTable) else line
            lines += [shorten(f"{key or 'robot'}: {text}", _LONGEST_LINE)] if text else []
        return "\n".join(lines[:_MOST_LINES])


class ResultDirectory(Result):
    """A result whose files are those of a directory; SERIES holds all of it."""

    contents: ClassVar[Contents]
    data: ClassVar[str] = ""  # file of the numbers, where it isn't the mark of `contents`

    def write_more(self, directory: Path, storage: Storage | None, progress: Progress) -> None:
        """Write what other results don't have."""

    @classmethod
    def check(
        cls, out: Path, *, overwrite: bool = False, inputs: Iterable[Path | None] = ()
    ) -> None:
        """Raise OutputError unless save() may write there. inputs: what must not be overwritten."""
        check_output_directory(out, overwrite=overwrite, contents=cls.contents, inputs=inputs)

    def save(
        self,
        out: Path | str,
        *,
        overwrite: bool = False,
        figures: Sequence[str] = ("png",),
        storage: Storage | None = None,
        inputs: Iterable[Path | None] = (),
        progress: Progress = no_progress,
    ) -> None:
        """Write all files into a directory, or none of them.

        Parameters
        ----------
        out
            The directory.
        overwrite
            Replace an older result.
        figures
            Formats of the figure: of "png", "svg", "pdf"; none of them: no figure.
        storage
            Of a recording among the files: "sqlite3" or "mcap"; by default that of the recording it was made of.
        inputs
            Further files that must not be overwritten.

        Raises
        ------
        UserError
            OutputError, BagError, MissingPackageError.
        """
        check_formats(figures)
        if storage is not None:
            check_storage(storage)
        inputs = (*self.inputs(), *inputs)
        whole = written_whole(Path(out), overwrite=overwrite, contents=self.contents, inputs=inputs)
        with whole as directory:
            self.write(directory, figures, storage=storage, progress=progress)

    @classmethod
    def load(cls, directory: Path | str) -> Self:
        """The result that save() wrote into a directory. Raises OutputError."""
        return _loaded(cls, Path(directory) / SERIES)

    def write(
        self,
        directory: Path,
        figures: Sequence[str] = (),
        *,
        storage: Storage | None = None,
        page: bool = True,
        progress: Progress = no_progress,
    ) -> None:
        """Write the files of `contents`. page: report.html, too."""
        files = self.contents.files
        self.write_more(directory, storage, progress)
        write_text(directory / (self.data or self.contents.mark), json_text(self.numbers()))
        np.savez(directory / SERIES, **stored(self))
        if PAGE in files and page:
            write_text(directory / PAGE, self.page())
        if figures:
            progress("plotting", 0, 1)
            drawn = (directory / f for s in figures for f in files if f.endswith(f".{s}"))
            save_figure(self.plot, *drawn)
            progress("plotting", 1, 1)


class ResultFiles(Result):
    """A result whose files lie beside each other: NAME.yaml, and others that are named after it."""

    # Of the others, but NAME.npz, which holds all of it; {stem}, {suffix}: those of NAME.yaml; {figure}: a format.
    names: ClassVar[tuple[str, ...]]
    reader: ClassVar[str | None] = None  # what takes NAME.yaml, in words; None: any suffix will do

    @abstractmethod
    def texts(self, files: Sequence[Path]) -> Iterable[str]:
        """Contents of the files that are texts, in their order."""

    def test(self, fresh: Sequence[Path]) -> None:
        """Raise UserError where the files, which are in a work folder, can't be used."""

    @classmethod
    def files(cls, out: Path | str, figures: Sequence[str] = ()) -> tuple[Path, ...]:
        """NAME.yaml, NAME.npz and the others, figures last. Raises OutputError."""
        out = Path(out)
        if cls.reader is not None and out.suffix not in (".yaml", ".yml"):
            raise OutputError(
                f"{out}: expected a name ending in .yaml{cls.reader}; name another file with --out"
            )
        parts = {"stem": out.stem, "suffix": out.suffix}
        names = (
            name.format(**parts, figure=figure)
            for name in (_SERIES_OF, *cls.names)
            for figure in (dict.fromkeys(figures) if "{figure}" in name else ("",))
        )
        return out, *map(out.with_name, names)

    @classmethod
    def check(
        cls,
        out: Path | str,
        *,
        overwrite: bool = False,
        figures: Sequence[str] = (),
        more: Mapping[str, Path] | None = None,
        inputs: Iterable[Path | None] = (),
    ) -> None:
        """Raise OutputError unless save() may write there.

        more: further files, by option. inputs: what must not be overwritten.
        """
        if any("{figure}" in name for name in cls.names):
            check_formats(figures)
        named = [*(("--out", f) for f in cls.files(out, figures)), *(more or {}).items()]
        inputs = tuple(inputs)
        for option, file in named:
            check_output_file(file, overwrite=overwrite, option=option, inputs=inputs)
        places = [file.absolute() for _, file in named]
        for (option, file), place in reversed(list(zip(named, places, strict=True))):
            if places.count(place) > 1:
                raise OutputError(
                    f"{file}: expected a file of its own for {option}, got one of the other results; "
                    "name another file"
                )

    def save(
        self,
        out: Path | str,
        *,
        overwrite: bool = False,
        figures: Sequence[str] = ("png",),
        more: Mapping[Path, str] | None = None,
    ) -> None:
        """Write NAME.yaml, which is `out`, and the others; all files, or none of them.

        overwrite: replace older ones. figures: formats, where there is a figure. more: texts of further
        files, by file. Raises OutputError, MissingPackageError.
        """
        more = more or {}
        options = {f"{file}": file for file in more}
        self.check(out, overwrite=overwrite, figures=figures, more=options, inputs=self.inputs())
        files = self.files(out)
        main, series, *others = files
        of_texts = (main, *others)
        texts = {**dict(zip(of_texts, self.texts(of_texts), strict=True)), **more}
        drawn = self.files(out, figures)[len(files) :]
        targets = [*files[1:], *drawn, *more, files[0]]  # last the one that names the others
        with files_written_whole(targets) as places:
            fresh = dict(zip(targets, places, strict=True))
            for file, text in texts.items():
                write_text(fresh[file], text)
            with fresh[series].open("wb") as opened:
                np.savez(opened, **stored(self))
            if drawn:
                save_figure(self.plot, *map(fresh.__getitem__, drawn))
            self.test([fresh[file] for file in of_texts])

    @classmethod
    def load(cls, out: Path | str) -> Self:
        """The result that save() wrote, by its NAME.yaml. Raises OutputError."""
        return _loaded(cls, cls.files(out)[1])


def _loaded(kind: type[R], file: Path) -> R:
    made = f"written by {kind.__name__}.save() or `ids`"
    if not file.is_file():
        raise OutputError(f"{file}: no such file; expected one {made}")
    try:
        with np.load(file, allow_pickle=False) as arrays:
            return restored(kind, arrays)
    except Exception as error:  # of files that are damaged or older, whatever their readers raise
        raise OutputError(
            f"{file}: expected a result of this version {made}, got another one "
            f"({type(error).__name__}: {error}); compute it again"
        ) from error


def files_of(mark: str, figure: str, *more: str, added: Sequence[str] = ()) -> Contents:
    """Files of a result's directory: numbers in `mark`, SERIES, a figure of that name in any format, more."""
    drawn = (f"{figure}.{suffix}" for suffix in FORMATS)
    return Contents(mark, (mark, SERIES, *more, *drawn), tuple(added))


def texts_of(lines: Iterable[T | tuple[str, Texts]]) -> Iterator[T | tuple[str, str]]:
    """The lines, a key with several texts as several lines."""
    for line in lines:
        if isinstance(line, tuple):
            key, texts = line
            for text in [texts] if isinstance(texts, (str, Path)) else texts:
                yield key, f"{text}"
        else:
            yield line
