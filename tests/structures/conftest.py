"""Fixtures of the structures' tests."""

import pytest
from structures_for_tests import FOLDER


@pytest.fixture(params=sorted(path.name for path in FOLDER.glob("*.yaml")))
def library_file(request):
    """The path of each structure of the library in turn."""
    return FOLDER / request.param
