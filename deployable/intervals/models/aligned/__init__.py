"""Event-aligned models: smooth pieces between impacts, and the times of these."""

from .model import AlignedModel

__all__ = ["AlignedModel"]
