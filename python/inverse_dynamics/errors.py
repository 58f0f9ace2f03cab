# SPDX-License-Identifier: Apache-2.0
"""Mistakes a user can repair. Each text says where, what was expected, what was found, the remedy.

The command line prints the text and ends with exit code 2; a script catches `UserError`.
"""

from inverse_dynamics.wording import message, told


class UserError(Exception):
    """Anything a user can put right: a file, an option, a name.

    Its text may quote a file: str() gives it printable and of bearable length, args as it is. It names options of
    the command `ids`, for which str() names arguments of functions outside of this command.
    """

    def __str__(self) -> str:
        return message(told(super().__str__()))


class PartialError(UserError):
    """Some of several recordings failed; the results of the others are written."""


class ArgumentError(UserError, TypeError):
    """An argument of a function that is missing, unknown, or of another type."""


class BagError(UserError):
    """A recording that can't be read or doesn't hold what is asked of it."""


class RobotError(UserError):
    """A run configuration that isn't there or isn't right."""


class PackageNotFoundError(UserError):
    """A package that isn't installed."""


class RecordingsError(UserError):
    """Public recordings that can't be fetched, or aren't the published ones."""


class OutputError(UserError):
    """A result that can't be written where it should go, or one that can't be read back."""


# What solvers raise: the C++ exceptions of inverse_dynamics_solver/exceptions.hpp, same texts.


class SolverError(UserError):
    """A solver that isn't installed or refuses what it was given."""


class PluginNotFoundError(SolverError):
    """No usable plugin of that name."""


class ParameterMissingError(SolverError):
    """A parameter without a default is missing."""


class InvalidParameterError(SolverError, ValueError):
    """A parameter is there, but of the wrong type, length or value."""


class InvalidRobotDescriptionError(InvalidParameterError):
    """The robot description isn't usable: not a URDF, no such link, no chain."""


class SizeMismatchError(SolverError, ValueError):
    """An array has the wrong size: not one number per joint, or not one row per state."""


class EvaluationError(UserError, ValueError):
    """Samples that can't be evaluated: inverse_dynamics_evaluation/error.hpp, same texts."""
