# SPDX-License-Identifier: Apache-2.0
"""Four robots on one page."""
