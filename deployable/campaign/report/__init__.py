"""The report of a campaign: one HTML page that moves (`page.py`), from plain data (`data.py`)."""

from deployable.campaign.report.motions import make_motions
from deployable.campaign.report.page import write_page
from deployable.campaign.report.read import from_results

__all__ = ["from_results", "make_motions", "write_page"]
