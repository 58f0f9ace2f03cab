# SPDX-License-Identifier: Apache-2.0
"""What touched a robot in a recording: method, files, tables, figure, page, verb."""
