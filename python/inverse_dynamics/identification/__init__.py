# SPDX-License-Identifier: Apache-2.0
"""From recordings to a model: fits, the choices among them, and how good they are on unseen data."""
