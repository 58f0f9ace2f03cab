# SPDX-License-Identifier: Apache-2.0
"""Recordings and tables of any format, in; a log of joints, out."""
