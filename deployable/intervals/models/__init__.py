"""Models of the responses over the box, from which bounds are taken (see `model.Model`)."""

from .model import Model
from .polynomial import PolynomialModel
from .scan import ScanModel
from .spline import SplineModel

__all__ = ["MODELS", "Model", "PolynomialModel"]

MODELS: dict[str, type[Model]] = {
    "polynomial": PolynomialModel,
    "spline": SplineModel,
    "scan": ScanModel,
}
