# SPDX-License-Identifier: Apache-2.0
"""Arguments that a function doesn't take: an error that names the argument, what was expected and got.

refused("Solver", "__init__(self: Solver, plugin: str) -> None", [solver], {})
# Solver: argument plugin: expected a text, got none
"""

from __future__ import annotations

import inspect
import os
import re
from functools import wraps
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec, TypeVar

import numpy as np

from inverse_dynamics.base.wording import counted, did_you_mean, harmless, shown
from inverse_dynamics.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_Result = TypeVar("_Result")
_Arguments = ParamSpec("_Arguments")


class _Parameter(NamedTuple):
    name: str
    type: str
    optional: bool
    by_name: bool


def refused(
    function: str, text: str, positional: Sequence[object], named: Mapping[str, object]
) -> ArgumentError:
    """The error of a call of a bound function; text: its docstring, which begins with its signature.

    function: the name of a function, of a method with its class (`Solver.torques`), or
    `Solver.__init__`.
    """
    signature = text.partition("\n")[0]
    function = function.removesuffix(".__init__")
    error = _mistake(function, _parameters(signature), positional, named)
    if error is None:
        types = ", ".join(_kind(value) for value in (*positional, *named.values()))
        error = f"{function}: arguments: expected {signature}, got {types}"
    return ArgumentError(error)


def checked(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """The function, which raises ArgumentError for arguments that its annotations don't allow.

    What it takes as `**options` isn't looked at.
    """
    parameters = _declared(function)
    kinds = [parameter.kind for parameter in inspect.signature(function).parameters.values()]
    open_ended = inspect.Parameter.VAR_KEYWORD in kinds
    own = {parameter.name for parameter in parameters}

    @wraps(function)
    def call(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> _Result:
        looked_at = {k: v for k, v in kwargs.items() if k in own} if open_ended else kwargs
        error = _mistake(function.__name__, parameters, args, looked_at)
        if error is not None:
            raise ArgumentError(error)
        return function(*args, **kwargs)

    return call


def check_call(function: Callable[..., object], *args: object, **kwargs: object) -> None:
    """Raise the ArgumentError that a checked function would raise of these arguments; don't call it."""
    error = _mistake(function.__name__, _declared(function), args, kwargs)
    if error is not None:
        raise ArgumentError(error)


def _declared(function: Callable[..., object]) -> list[_Parameter]:
    return [
        _Parameter(
            parameter.name,
            str(parameter.annotation),
            parameter.default is not parameter.empty,
            parameter.kind is parameter.KEYWORD_ONLY,
        )
        for parameter in inspect.signature(function).parameters.values()
        if parameter.kind is not parameter.VAR_KEYWORD
    ]


def _mistake(
    function: str,
    parameters: Sequence[_Parameter],
    positional: Sequence[object],
    named: Mapping[str, object],
) -> str | None:
    """What is wrong with the arguments; None where each of them is of its type."""
    places = [parameter.name for parameter in parameters if not parameter.by_name]
    known = [parameter.name for parameter in parameters if parameter.name != "self"]
    if len(positional) > len(places):
        own = int("self" in places)
        most, got = len(places) - own, len(positional) - own
        return f"{function}: expected at most {counted(most, 'argument')} without a name, got {got}"
    given = dict(zip(places, positional, strict=False))
    for name, value in named.items():
        where = f"{function}: argument {harmless(name)}"
        if name in given:
            return f"{where}: expected once, got twice"
        if name not in known:
            hint = did_you_mean(name, known)
            return f"{where}: unknown; {f'{hint} ' if hint else ''}known: {', '.join(known)}"
        given[name] = value
    for parameter in parameters:
        expected, fits = _expectation(parameter.type)
        where = f"{function}: argument {parameter.name}: expected {expected}"
        if parameter.name not in given:
            if not parameter.optional:
                return f"{where}, got none"
        elif not fits(given[parameter.name]):
            return f"{where}, got {_kind(given[parameter.name], of='three' in expected)}"
    return None


# ---------------------------------------------------------------- signatures, as pybind11 writes them


def _parameters(signature: str) -> list[_Parameter]:
    parameters: list[_Parameter] = []
    by_name = False
    for part in _split(signature.partition("(")[2], ","):
        name, _, rest = part.partition(":")
        annotation, _, default = rest.partition(" = ")
        if name == "*":
            by_name = True
        elif name:
            parameters.append(_Parameter(name, annotation.strip(), bool(default), by_name))
    return parameters


def _split(text: str, separator: str) -> list[str]:
    """Parts between separators outside of brackets, up to a bracket that closes what wasn't opened."""
    parts, depth = [""], 0
    for character in text:
        depth += (character in "([{<") - (character in ")]}>")
        if depth < 0:
            break
        if character == separator and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts]


# ---------------------------------------------------------------- types


def _is_number(value: object) -> bool:
    return hasattr(value, "__float__") or hasattr(value, "__index__")


def _is_array(value: object) -> bool:
    try:
        return np.asarray(value).dtype.kind in "biuf"
    except ValueError:  # rows of different lengths
        return False


def _is_mask(value: object) -> bool:
    return _is_array(value) and np.asarray(value).dtype.kind == "b"


def _are(fits: Callable[[object], bool], count: int | None = None) -> Callable[[Any], bool]:
    """Whether a value is a sequence, or an array, of such values, or of so many."""

    def test(value: Any) -> bool:
        if isinstance(value, (str, bytes)) or not hasattr(value, "__len__"):
            return False
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return False
        return count in (None, len(value)) and all(map(fits, value))

    return test


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _is_path(value: object) -> bool:
    return isinstance(value, (str, os.PathLike))


def _are_paths(value: Any) -> bool:
    """Whether these are paths; an iterator would be used up, so what it gives isn't looked at."""
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        return False
    return not hasattr(value, "__len__") or all(map(_is_path, value))


# Type in a signature or an annotation, in words, and whether a value is of it. The first that matches counts.
_KINDS: tuple[tuple[str, str, Callable[[Any], bool]], ...] = (
    (r"None", "None", lambda value: value is None),
    (r"bool", "True or False", lambda value: isinstance(value, (bool, np.bool_))),
    (r"str|Clock", "a text", _is_text),
    (
        r"(pathlib\.)?Path|os\.PathLike\[str\]",
        "a path",
        lambda value: isinstance(value, os.PathLike),
    ),
    (r".*ArrayLike, numpy\.bool\].*", "an array of True and False", _is_mask),
    (r".*(ArrayLike|NDArray|ndarray).*", "an array of real numbers", _is_array),
    (r".*(Sequence|[Ll]ist)\[str\].*", "a list of texts", _are(_is_text)),
    (r"Iterable\[Path \| str\]", "paths", _are_paths),
    (
        r".*(FixedSize\(3\)|tuple\[float, float, float\]).*",
        "three numbers",
        _are(_is_number, 3),
    ),
    (
        r".*(dict|Mapping).*",
        "a dictionary whose keys are texts",
        lambda value: hasattr(value, "keys") and all(map(_is_text, value.keys())),
    ),
    (r"(typing\.)?SupportsInt|int", "a whole number", lambda value: hasattr(value, "__index__")),
    (r"(typing\.)?SupportsFloat|float", "a number", _is_number),
)


def _expectation(annotation: str) -> tuple[str, Callable[[object], bool]]:
    """A type in words, and whether a value is of it; of types that aren't known here any value is."""
    optional = re.fullmatch(r"(?:typing\.)?Optional\[(.*)\]", annotation)
    alternatives = [*_split(optional[1], "|"), "None"] if optional else _split(annotation, "|")
    words: list[str] = []
    tests: list[Callable[[Any], bool]] = []
    for alternative in alternatives:
        if alternative.endswith("SupportsIndex"):  # beside SupportsInt and SupportsFloat
            continue
        word, fits = _kind_of(alternative)
        words.append(word)
        tests.append(fits)
    return " or ".join(words), lambda value: any(fits(value) for fits in tests)


def _kind_of(alternative: str) -> tuple[str, Callable[[Any], bool]]:
    for pattern, word, fits in _KINDS:
        if re.fullmatch(pattern, alternative):
            return word, fits
    name = alternative.rpartition(".")[2]
    if "." not in alternative and name != "Robot":
        return "a value", lambda _: True
    return f"a {name}", lambda value: name in {base.__name__ for base in type(value).__mro__}


def _kind(value: object, *, of: bool = False) -> str:
    """What a value is, in a few words; of: with how many entries."""
    if of and isinstance(value, (list, tuple)):
        return f"a {type(value).__name__} of {len(value)}"
    if value is None or isinstance(value, (bool, int, float, str)):
        return shown(value) if isinstance(value, str) else harmless(value)
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    return f"an object of type {type(value).__name__}"
