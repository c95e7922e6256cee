"""The report of a campaign: one HTML page that moves (`page.py`), from plain data (`data.py`)."""

from campaign.report.data import Event, MovingRun, PageData, Parameter, Response, Run, Work
from campaign.report.page import write_page

__all__ = [
    "Event",
    "MovingRun",
    "PageData",
    "Parameter",
    "Response",
    "Run",
    "Work",
    "write_page",
]
