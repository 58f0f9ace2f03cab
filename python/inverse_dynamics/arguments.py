# SPDX-License-Identifier: Apache-2.0
"""Arguments that a function doesn't take: an error that names the argument, what was expected and got.

refused("Solver", "__init__(self: Solver, plugin: str) -> None", [solver], {})
# Solver: argument plugin: expected a text, got none
"""

from __future__ import annotations

import ast
import os
import re
from contextlib import suppress
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from inverse_dynamics.errors import ArgumentError
from inverse_dynamics.wording import counted, did_you_mean, harmless, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_Result = TypeVar("_Result")
_Arguments = ParamSpec("_Arguments")


def refused(
    function: str, text: str, positional: Sequence[object], named: Mapping[str, object]
) -> ArgumentError:
    """The error of a call of a bound function; text: its docstring, which begins with its signature.

    function: the name of a function, of a method with its class (`Solver.torques`), or
    `Solver.__init__`.
    """
    function, error = function.removesuffix(".__init__"), None
    with suppress(AttributeError):
        parameters = list(signature_of(text).parameters.values())
        error = _mistake(function, parameters, positional, named)
    if error is None:
        types = ", ".join(_kind(value) for value in (*positional, *named.values()))
        head = text.partition("\n")[0]
        error = f"{function}: arguments: expected {head}, got {types}"
    return ArgumentError(error)


def signature_of(text: str) -> Signature:
    """The signature that a docstring of pybind11 begins with; a default that is no literal is `...`.

    Raises AttributeError where it isn't Python, as C++ is, which pybind11 writes for types that it doesn't know.
    """
    head = re.sub(r"= <[^>]*>", "= ...", text.partition("\n")[0])
    try:
        tree = ast.parse(f"def {head}: ...")
    except SyntaxError as error:
        raise AttributeError(f"no signature: {head}") from error
    (definition,) = tree.body
    assert isinstance(definition, ast.FunctionDef)
    arguments = definition.args
    arguments.defaults = [_literal(default) for default in arguments.defaults]
    arguments.kw_defaults = [default and _literal(default) for default in arguments.kw_defaults]
    names: dict[str, Any] = {}
    exec(compile(tree, "signature", "exec", annotations.compiler_flag), names)
    return signature(names[definition.name])


def _literal(default: ast.expr) -> ast.expr:
    try:
        ast.literal_eval(default)
    except ValueError:
        return ast.copy_location(ast.Constant(...), default)
    return default


def checked(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """The function, which raises ArgumentError for arguments that its annotations don't allow.

    Its signature names what it takes as `**options: Unpack[OPTIONS]`, a dictionary type of its module.
    """

    @wraps(function)
    def call(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> _Result:
        check_call(call, *args, **kwargs)
        return function(*args, **kwargs)

    call.__signature__ = _unpacked(function)  # type: ignore[attr-defined]
    return call


def _unpacked(function: Callable[..., object]) -> Signature:
    """The signature with a parameter for each of its options."""
    own = signature(function)
    *parameters, last = own.parameters.values()
    if last.kind is not Parameter.VAR_KEYWORD:
        return own
    options = function.__globals__[last.annotation.removeprefix("Unpack[").removesuffix("]")]
    parameters += [
        Parameter(name, Parameter.KEYWORD_ONLY, default=..., annotation=kind.__forward_arg__)
        for name, kind in options.__annotations__.items()
    ]
    return own.replace(parameters=parameters)


def check_call(function: Callable[..., object], *args: object, **kwargs: object) -> None:
    """Raise the ArgumentError that a checked function would raise of these arguments; don't call it."""
    error = _mistake(function.__name__, list(signature(function).parameters.values()), args, kwargs)
    if error is not None:
        raise ArgumentError(error)


def _mistake(
    function: str,
    parameters: Sequence[Parameter],
    positional: Sequence[object],
    named: Mapping[str, object],
) -> str | None:
    """The first mistake in the arguments; None if there is none."""
    places = [p.name for p in parameters if p.kind is not Parameter.KEYWORD_ONLY]
    known = [p.name for p in parameters if p.name != "self"]
    if len(positional) > len(places):
        first = int("self" in places)
        most, got = len(places) - first, len(positional) - first
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
        expected, fits = _expectation(str(parameter.annotation))
        where = f"{function}: argument {parameter.name}: expected {expected}"
        if parameter.name not in given:
            if parameter.default is Parameter.empty:
                return f"{where}, got none"
        elif not fits(given[parameter.name]):
            return f"{where}, got {_kind(given[parameter.name], of='three' in expected)}"
    return None


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
    """Whether these are paths. Doesn't look into an iterator, which that would exhaust."""
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
    """A type in words, and a test of values, which all pass if the type isn't known here."""
    kinds = [
        _kind_of(alternative)
        for alternative in _alternatives(ast.parse(annotation, mode="eval").body)
        if not alternative.endswith("SupportsIndex")  # beside SupportsInt and SupportsFloat
    ]
    words = " or ".join(word for word, _ in kinds)
    return words, lambda value: any(fits(value) for _, fits in kinds)


def _alternatives(annotation: ast.expr) -> list[str]:
    """Types of a union; of Optional[X], X and None."""
    if isinstance(annotation, ast.BinOp):
        return _alternatives(annotation.left) + _alternatives(annotation.right)
    if isinstance(annotation, ast.Subscript) and ast.unparse(annotation.value).endswith("Optional"):
        return [*_alternatives(annotation.slice), "None"]
    return [ast.unparse(annotation)]


def _kind_of(alternative: str) -> tuple[str, Callable[[Any], bool]]:
    for pattern, word, fits in _KINDS:
        if re.fullmatch(pattern, alternative):
            return word, fits
    name = alternative.rpartition(".")[2]
    if "." not in alternative and name not in ("Robot", "DataFrame"):
        return "a value", lambda _: True
    return f"a {name}", lambda value: name in {base.__name__ for base in type(value).__mro__}


def _kind(value: object, *, of: bool = False) -> str:
    """A value in a few words; of: with the number of its entries."""
    if of and isinstance(value, (list, tuple)):
        return f"a {type(value).__name__} of {len(value)}"
    if value is None or isinstance(value, (bool, int, float, str)):
        return shown(value) if isinstance(value, str) else harmless(value)
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} of shape {value.shape}"
    return f"an object of type {type(value).__name__}"
