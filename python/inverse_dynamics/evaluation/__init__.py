# SPDX-License-Identifier: Apache-2.0
"""From a recording to computed torques and their errors: method, files, page, figure, verb."""
