# SPDX-License-Identifier: Apache-2.0
"""Former names of modules."""
