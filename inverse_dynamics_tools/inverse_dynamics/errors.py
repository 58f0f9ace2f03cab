# SPDX-License-Identifier: Apache-2.0
"""Mistakes a user can repair. Each text says where, what was expected, what was found, the remedy.

The command line prints the text and ends with exit code 2; a script catches `UserError`.
"""


class UserError(Exception):
    """Anything a user can put right: a file, an option, a name."""


class BagError(UserError):
    """A recording that can't be read or doesn't hold what is asked of it."""


class RobotError(UserError):
    """A run configuration that isn't there or isn't right."""


class SolverError(UserError):
    """A solver that isn't installed or refuses what it was given."""


class OutputError(UserError):
    """A result that can't be written where it should go, or one that can't be read back."""
