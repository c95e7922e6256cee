"""Arithmetic with units, and nothing that is not arithmetic."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fpm.arithmetic.expressions import ExpressionError, parse
from fpm.arithmetic.units import NAMES, NUMBER, Dimension, UnitError, unit

LENGTH, TIME = Dimension(length=1), Dimension(time=1)


VALUES = {
    "35 mm": 0.035, "35mm": 0.035, "1e9 Pa": 1e9, "0.1 N m/rad": 0.1,
    "180 N m/deg": 180 * 180 / math.pi, "90 deg": math.pi / 2, "30 rpm": math.pi, "5 /s": 5.0,
    "5/s": 5.0, "9.81 m/s2": 9.81, "(2 mm)**2": 4e-6, "6 m/2": 3.0, "-2**2": -4.0,
    "2*(1 + 3)/4": 2.0, "min(3 mm, 2 mm) + max(1 m, 2 m)": 2.002,
    "atan2(1, -1)": 3 * math.pi / 4, "sqrt(16 m2)": 4.0, "abs(-pi)": math.pi,
    "interpolate(0, -40, 11 mm, 20, 5 mm, 80, 4 mm)": 0.007, "interpolate(20, -4, 1, 20, 5)": 5.0,
    "interpolate(-90, -40, 11, 20, 5, 80, 4)": 11.0, "interpolate(90, -40, 11, 20, 5, 80, 4)": 4.0,
}  # fmt: skip


def value(text, **names):
    return parse(text).value(names)


@pytest.mark.parametrize("text", VALUES)
def test_numbers_and_units(text):
    assert value(text) == pytest.approx(VALUES[text], rel=1e-15)


SAME = {  # every unit, by the base units or by another one
    "m": "m", "mm": ("m", 1e-3), "cm": ("m", 1e-2), "um": ("m", 1e-6), "km": ("m", 1e3),
    "kg": "kg", "s": "s", "ms": ("s", 1e-3), "us": ("s", 1e-6), "N": "kg m/s2", "kN": ("N", 1e3),
    "MN": ("N", 1e6),
    "Pa": "N/m2", "kPa": ("Pa", 1e3), "MPa": ("Pa", 1e6), "GPa": ("Pa", 1e9), "J": "N m",
    "rad": "m/m", "mrad": ("rad", 1e-3), "deg": ("rad", math.pi / 180), "Hz": "/s",
    "rpm": ("Hz", 2 * math.pi / 60),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_unit_is_what_its_name_says(name):
    other, factor = SAME[name] if isinstance(SAME[name], tuple) else (SAME[name], 1.0)
    one, base = unit(name), unit(other)
    assert one.si(1.0) == pytest.approx(factor * base.si(1.0), rel=1e-15)
    assert one.dimension.powers == base.dimension.powers
    in_si = {"m": (0, 1, 0), "kg": (1, 0, 0), "s": (0, 0, 1), "m/m": (0, 0, 0)}
    if other in in_si:
        assert base.si(1.0) == 1.0
        assert base.dimension.powers == in_si[other]


def test_names_and_coordinates():
    assert value("L*cos(stow) - B.x", L=2.0, stow=0.0, **{"B.x": 0.5}) == 1.5
    assert parse("L*cos(stow) - bay1.B.x").names == {"L", "stow", "bay1.B.x"}


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(0.1, 1e3))
def test_the_value_is_python_s(x, y, z):
    text = "(x + 2*y)/z - x*y**2 + -sqrt(z)*sin(x)*atan2(y, z)"
    found = (x + 2 * y) / z - x * y**2 + -math.sqrt(z) * math.sin(x) * math.atan2(y, z)
    assert value(text, x=x, y=y, z=z) == found


NO_ARITHMETIC = (
    "__import__('os').system('true')", "().__class__.__bases__", "(1).real", "L.real()",
    "[x for x in (1, 2)]", "lambda: 1", "1 if L else 2", "L if 1 else 2", "not 1", "1 < 2",
    "1 or 2", "f'{1}'", "'a'", "True", "None", "1j", "L[0]", "*L", "L := 1", "1 // 2", "7 % 4",
    "1 << 9", "~1", "a @ b", "open(1)", "eval(1)", "cos", "cos.x(1)", "cos(1, 2)", "cos(x=1)",
    "cos(*L)", "_0_", "2 ** ", "", "(" * 300, "1" * 501, "\x00", "a\nb", "await x", "yield",
    "print", "interpolate(1, 2, 3, 4)", "interpolate(1, 2, 3)",
)  # fmt: skip


@pytest.mark.parametrize("text", NO_ARITHMETIC)
def test_what_is_not_arithmetic_is_refused(text):
    with pytest.raises(ExpressionError):
        expression = parse(text)
        expression.dimension(dict.fromkeys(expression.names, NUMBER))
        assert expression.names == {"print"}  # a name like any other, which no file defines
        raise ExpressionError(text)


@pytest.mark.parametrize("text", ["1/0", "sqrt(-1)", "acos(2)", "(-1)**0.5", "9**9**9**9",
                                  "1" * 400, "1e400", "1e308*10", "0**-1"])  # fmt: skip
def test_what_has_no_value_is_refused(text):
    with pytest.raises(ExpressionError, match="no finite number"):
        value(text)


@pytest.mark.parametrize("text", ["interpolate(1, 0, 1, 0, 2)", "interpolate(1, 2, 1, 0, 2)"])
def test_tables_whose_places_do_not_increase_are_refused(text):
    with pytest.raises(ExpressionError, match="do not increase"):
        value(text)


REFUSED = {
    "L + t": "cannot be added",
    "L + 1": "a number without unit and m cannot be added",
    "L - 90 deg": "cannot be subtracted",
    "max(L, t)": "cannot be values of one max",
    "sin(L)": "sin takes a number or an angle, not m",
    "sin(45)": "an angle with a unit",
    "2**L": "an exponent is a number",
    "L**x": "plain number as exponent",
    "atan2(L, t)": "values of one atan2",
    "interpolate(x, 1, L, 2, t)": "values of one interpolate",
    "interpolate(L, 1, 0, 2, 1)": "places of one interpolate",
    # what a unit behind a number belongs to is never guessed
    "0.018 m**3*x": r"0\.018 m\*\*: a power right after a unit .* allowed: .*3 m2.*\(3 m\)",
    "3 m/s**2": "a power right after a unit",
    "2mm ** 2": "a power right after a unit",
    "2**3 deg": "an exponent is a number without unit",
    "2**-3 m": "an exponent is a number without unit",
    "1/2 deg": r"a plain number over an angle .* allowed: brackets as in \(1/2\)\*\(1 deg\)",
    "360/-12 mrad": "a plain number over an angle",
}


@pytest.mark.parametrize("text", REFUSED)
def test_units_that_do_not_fit_are_refused(text):
    with pytest.raises(ExpressionError, match=REFUSED[text]):
        parse(text).dimension({"L": LENGTH, "t": TIME, "x": NUMBER})


def test_quotients_that_can_be_meant_in_one_way_only_are_taken():
    found = {
        "90 deg/5 deg": 18.0,
        "a/90 deg": 2.0,
        "180/(90 deg)": 360 / math.pi,
        "1/2 rad": 0.5,
        "2 kg m^2/(1 kg·m²)": 2.0,
        "3 m²/m": 3.0,
    }
    for text, right in found.items():
        parse(text).dimension({"a": NUMBER})
        assert value(text, a=math.pi) == pytest.approx(right)


POWERS = {
    "L**2/t": (0, 2, -1), "sqrt(L**2)": (0, 1, 0), "L**(1/2)*L**0.5": (0, 1, 0),
    "2 kg*L/t**2": (1, 1, -2), "L/L": (0, 0, 0), "2*3": (0, 0, 0),
}  # fmt: skip


@pytest.mark.parametrize("text", POWERS)
def test_dimensions_follow_the_arithmetic(text):
    assert parse(text).dimension({"L": LENGTH, "t": TIME}).powers == POWERS[text]


def test_units_are_spelt_as_netcdf_has_them():
    spelt = {"N m/rad": "N m rad-1", "N m rad-1": "N m rad-1", "1/s": "s-1", "deg": "degree",
             "kg/m3": "kg m-3", "": "1", "1": "1", "mm2": "mm2",
             "N·m·s²/rad^2": "N m s2 rad-2"}  # fmt: skip
    assert {text: unit(text).udunits for text in spelt} == spelt


FAULTS = {
    "70 Gpa": r"'Gpa' is not a unit \(did you mean GPa", "2L": r"did you mean 2\*L",
    "L*sin(x": r"a bracket \) is missing",
}  # fmt: skip


@pytest.mark.parametrize("text", FAULTS)
def test_a_fault_of_an_expression_is_named(text):
    with pytest.raises(ExpressionError, match=FAULTS[text]):
        parse(text)


@pytest.mark.parametrize(("text", "guess"), [
    ("Nm", "N m"), ("Nm/rad", "N m/rad"), ("mpa", "MPa"), ("degrees", "deg"), ("KN", "kN"),
    ("degF", ""), ("mV", ""), ("mi", ""), ("kΩ", ""),
])  # fmt: skip
def test_unknown_units_are_refused_and_no_unit_of_other_things_is_proposed(text, guess):
    hint = rf" \(did you mean {guess}\?\)" if guess else ""
    with pytest.raises(UnitError, match=rf"^'{text}' is not a unit{hint}; "):
        unit(text)
