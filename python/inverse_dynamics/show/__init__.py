# SPDX-License-Identifier: Apache-2.0
"""What pages and figures are made of: skeleton, plots, tables, 3D scene, colours."""
