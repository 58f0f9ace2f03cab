# SPDX-License-Identifier: Apache-2.0
"""The report: evaluations as one page of HTML, with the robot in motion beside its torques.

write_page(Path("report.html"), "My robot", [report_run(evaluation)])
"""

from inverse_dynamics.report.evaluations import report_comparison, report_run
from inverse_dynamics.report.page import write_page

__all__ = ["report_comparison", "report_run", "write_page"]
