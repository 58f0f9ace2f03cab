# SPDX-License-Identifier: Apache-2.0
"""The torques of a planned trajectory: method, files, verb."""
