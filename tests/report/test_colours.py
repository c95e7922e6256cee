"""The colours of runs can be told apart by everybody, and from the paper."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

STYLE = Path(__file__).parents[2] / "deployable/campaign/report/style.css"
RUNS = ("ink", "low", "high", "third", "fourth", "fifth", "sixth")

# What a light of linear sRGB becomes to those who lack one kind of cone: Machado, Oliveira and
# Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, severity 1.
VISIONS = {
    "three cones": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                   [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                     [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                   [0.004733, 0.691367, 0.303900]],
}  # fmt: skip
# From linear sRGB to CIE XYZ (IEC 61966-2-1).
XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
                [0.0193339, 0.1191920, 0.9503041]])  # fmt: skip


def colours(theme):
    """The colours of a theme of the page by name, in linear sRGB (3,)."""
    blocks = re.findall(r":root.*?\{(.*?)\}", STYLE.read_text(encoding="utf-8"), re.S)
    found = re.findall(r"--(\w+): #([0-9a-f]{6})", blocks[("light", "dark").index(theme)])
    parts = {name: [int(text[i : i + 2], 16) / 255 for i in (0, 2, 4)] for name, text in found}
    return {name: np.array([_linear(part) for part in each]) for name, each in parts.items()}


def _linear(part):
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


def lab(light):
    """CIE L*a*b* (white D65) of a light in linear sRGB."""
    share = XYZ @ np.clip(light, 0, 1) / XYZ.sum(axis=1)
    x, y, z = np.where(share > (6 / 29) ** 3, np.cbrt(share), share / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_lab_is_that_of_known_colours():
    np.testing.assert_allclose(lab(np.ones(3)), [100, 0, 0], atol=0.01)
    np.testing.assert_allclose(lab([1, 0, 0]), [53.24, 80.09, 67.20], atol=0.02)


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("vision", VISIONS)
def test_runs_differ_to_every_kind_of_vision(theme, vision):
    """By 20 (CIE 1976), some ten times what is just seen side by side."""
    seen = {name: lab(VISIONS[vision] @ colours(theme)[name]) for name in RUNS}
    for one, other in itertools.combinations(RUNS, 2):
        assert np.linalg.norm(seen[one] - seen[other]) > 20, (one, other)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_lines_stand_out_from_the_paper_and_words_more(theme):
    """By the contrast that WCAG 2.1 asks of graphics (3) and of words (4.5)."""
    found = {name: XYZ[1] @ light + 0.05 for name, light in colours(theme).items()}

    def contrast(name):
        return max(found[name], found["card"]) / min(found[name], found["card"])

    assert min(contrast(name) for name in RUNS) > 2.99
    assert min(contrast(name) for name in ("ink", "soft", "good", "warn", "bad")) > 4.5
