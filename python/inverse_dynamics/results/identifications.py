# SPDX-License-Identifier: Apache-2.0
"""The former name of inverse_dynamics.identification.files, for one more version."""

from inverse_dynamics.identification.files import *  # noqa: F403
