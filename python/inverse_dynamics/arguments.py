# SPDX-License-Identifier: Apache-2.0
"""Wrong arguments: one line that names the function, the argument, what was expected and what was given.

Solver("ur10_real", tpi="tool0")  # Solver: argument tpi: unknown; did you mean tip?
"""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Sized
from contextlib import suppress
from functools import wraps
from inspect import Parameter, Signature, isroutine, signature
from reprlib import repr as short
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, SupportsFloat, SupportsIndex, TypeVar

import numpy as np

from inverse_dynamics.errors import ArgumentError
from inverse_dynamics.wording import did_you_mean, harmless

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

_Result = TypeVar("_Result")
_Arguments = ParamSpec("_Arguments")


def checked(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """The function, which raises ArgumentError for arguments that its annotations don't allow.

    Options that it takes as `**options: Unpack[OPTIONS]`, a TypedDict of its module, are in its signature.
    """

    @wraps(function)
    def call(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> _Result:
        check_call(call, *args, **kwargs)
        return function(*args, **kwargs)

    *parameters, last = signature(function).parameters.values()
    if last.kind is Parameter.VAR_KEYWORD:
        options = function.__globals__[last.annotation[len("Unpack[") : -1]].__annotations__
        parameters += [
            Parameter(name, Parameter.KEYWORD_ONLY, default=..., annotation=kind.__forward_arg__)
            for name, kind in options.items()
        ]
        own = signature(function).replace(parameters=parameters)
        call.__signature__ = own  # type: ignore[attr-defined]
    return call


def check_call(function: Callable[..., object], /, *args: object, **kwargs: object) -> None:
    """Raise the ArgumentError that a function would raise of these arguments; don't call it."""
    place, known = function.__qualname__.removesuffix(".__init__"), signature(function).parameters
    names = [name for name in known if name != "self"]
    unknown = [name for name in kwargs if name not in names]
    if unknown and all(p.kind is not Parameter.VAR_KEYWORD for p in known.values()):
        word = rf"\b{re.escape(unknown[0])}\b"  # `robot` of `plugin: Robot | str`
        takes = [n for n in names if re.search(word, _readable(str(known[n].annotation)), re.I)]
        hint = f"did you mean {takes[0]}?" if takes else did_you_mean(unknown[0], names)
        hint = hint or f"known: {', '.join(names)}"
        raise ArgumentError(f"{place}: argument {harmless(unknown[0])}: unknown; {hint}")
    try:
        given = signature(function).bind(*args, **kwargs).arguments
    except TypeError as error:
        by_name = [n for n in names if known[n].kind is Parameter.KEYWORD_ONLY]
        takes = [n for n in names if n not in by_name]
        takes += [f"{n}=" for n in by_name if known[n].default is Parameter.empty]
        raise ArgumentError(f"{place}: {error}; it takes {', '.join(takes) or 'none'}") from None
    for key, value in given.items():
        expected = _readable(str(known[key].annotation))
        if not _fits(value, expected):
            raise ArgumentError(f"{place}: argument {key}: expected {expected}, got {_kind(value)}")


def explain(module: ModuleType, wrapped: Callable[[object, dict[str, str]], Any]) -> None:
    """Wrap what a module of pybind11 has bound, so that it has signatures and readable errors."""
    owners: list[Any] = [module, *(v for v in vars(module).values() if isinstance(v, type))]
    for owner in owners:
        for name, value in list(vars(owner).items()):
            bound: Any = value if owner is module else getattr(value, "__func__", None)
            if not isroutine(bound) or (name[0] == "_" and name != "__init__"):
                continue
            place = name if owner is module else f"{owner.__name__}.{name}"
            doc = bound.__doc__ or ""
            head, text = doc.partition("\n")[0], doc.partition("\n\n")[2]
            about = {"__name__": name, "__qualname__": place, "__doc__": text, "head": head}
            function = wrapped(bound, about)
            type(function).__signature__ = property(signature_of)
            is_static = isinstance(value, staticmethod)
            setattr(owner, name, staticmethod(function) if is_static else function)


def signature_of(function: Any) -> Signature:
    """The signature in its docstring of pybind11; a default that is no literal is `...`."""
    found = re.fullmatch(r"\w+\((.*?)\)(?: -> (.*))?", function.head)
    assert found
    parameters: list[Parameter] = []
    kind: Any = Parameter.POSITIONAL_OR_KEYWORD
    for text in re.split(r", (?=\w+: |\*)", found[1]) if found[1] else ():
        name, _, rest = text.partition(": ")
        annotation, optional, literal = rest.partition(" = ")
        if name == "*":
            kind = Parameter.KEYWORD_ONLY
        elif name[0] == "*":
            many = Parameter.VAR_KEYWORD if name[1] == "*" else Parameter.VAR_POSITIONAL
            parameters.append(Parameter(name.strip("*"), many))
        else:
            default: object = ... if optional else Parameter.empty
            with suppress(ValueError, SyntaxError):
                default = ast.literal_eval(literal)
            parameters.append(Parameter(name, kind, default=default, annotation=annotation))
    return Signature(parameters, return_annotation=found[2])


def raiser(function: Any, error: Exception) -> Callable[..., NoReturn] | None:
    """What raises the readable error of a call that ended in this one; None: it isn't about arguments."""
    if not re.match(r".*\): incompatible |Unable to cast Python instance", str(error)):
        return None

    def refuse(*args: object, **kwargs: object) -> NoReturn:
        check_call(function, *args, **kwargs)
        expected = _readable(function.head.partition(" -> ")[0])
        got = ", ".join(map(_kind, (*args, *kwargs.values())))
        raise ArgumentError(f"{function.__qualname__}: expected {expected}, got {got}")

    return refuse


_READABLE = {
    r"\bRecorded\b": "Path | str | JointLog | Mapping[str, Any] | DataFrame",
    r"\b(?:[A-Za-z_]\w*\.)+(?=\w)": "",  # modules
    r"SupportsFloat( \| SupportsIndex)?": "float",
    r"SupportsInt( \| SupportsIndex)?": "int",
    r"Optional\[(.*)\]$": r"\1 | None",
    r"Annotated\[\w+\[float\], .?FixedSize\(3\).?\]": "tuple[float, float, float]",
    r"(?:ndarray\[|Annotated\[ArrayLike, )\w+(?:\[m, 1\]|, .\[m, 1\].)\]": "vector",
    r"(?:ndarray\[|Annotated\[ArrayLike, )(\w+)\]": r"array of \1",
}
_CLASSES: dict[str, Any] = {
    "None": type(None),
    "bool": (bool, np.bool_),
    "int": SupportsIndex,
    "float": (SupportsFloat, SupportsIndex),
    "str": str,
    "Path": os.PathLike,
    "PathLike": os.PathLike,
}


def _readable(annotation: str) -> str:
    """A type without modules, and as Python has it: `float` of `typing.SupportsFloat | typing.SupportsIndex`."""
    for of_pybind11, readable in _READABLE.items():
        annotation = re.sub(of_pybind11, readable, annotation)
    return annotation


def _fits(value: Any, expected: str) -> bool:
    """Whether a value is of a type as _readable() has it; True where that can't be told."""
    kinds, depth = [""], 0
    for letter in expected:
        depth += (letter == "[") - (letter == "]")
        if letter == "|" and depth == 0:
            kinds.append("")
        else:
            kinds[-1] += letter
    return any(_is(value, kind.strip()) for kind in kinds)


def _is(value: Any, kind: str) -> bool:
    name, _, inner = kind.removesuffix("]").partition("[")
    if name in _CLASSES:
        return isinstance(value, _CLASSES[name]) and getattr(value, "ndim", 0) == 0
    if name == "vector" or "rray" in name:
        with suppress(ValueError):  # rows of different lengths
            array = np.asarray(value)
            fits = name != "vector" or array.ndim == 1 or array.shape[1:] == (1,)
            return fits and array.dtype.kind in ("b" if "bool" in kind else "biuf")
        return False
    if name in ("Sequence", "Iterable", "list", "tuple"):
        if isinstance(value, (str, bytes)) or not np.iterable(value):
            return False
        if not isinstance(value, Sized):  # looking into an iterator would exhaust it
            return True
        kinds = inner.split(", ") if name == "tuple" and inner else [inner] * len(value)
        return len(value) == len(kinds) and all(map(_fits, value, kinds))
    if name in ("dict", "Mapping"):
        return hasattr(value, "keys") and all(isinstance(key, str) for key in value)
    if name in ("DataFrame", "JointLog", "Evaluation"):  # modules that needn't be there
        named = isinstance(value, np.ndarray) and value.dtype.names is not None
        return (named and name == "DataFrame") or name in [
            base.__name__ for base in type(value).__mro__
        ]
    return isinstance(value, getattr(sys.modules.get("inverse_dynamics._core"), kind, object))


def _kind(value: object) -> str:
    """A value in a few words."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} {value.shape}"
    if value is None or isinstance(value, (bool, int, float, str, list, tuple, dict)):
        return " ".join(short(value).split())
    return f"an object of type {type(value).__name__}"
