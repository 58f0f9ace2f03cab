# SPDX-License-Identifier: Apache-2.0
"""The former name of inverse_dynamics.payload.payload, for one more version."""

from inverse_dynamics.payload.payload import *  # noqa: F403
