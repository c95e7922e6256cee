"""Numbers as people write them: the same in the summary, on the page and in figures."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

_NO_BREAK = "\N{NO-BREAK SPACE}"
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_ANGLES = {"degree": "°", "rad": " rad"}


def pretty(units: str) -> str:
    """Write units as people do: `m s-1` as `m/s`, `kg m2 s-2` as `kg m²/s²`; no unit as `1`."""
    numerator: list[str] = []
    denominator: list[str] = []
    for name, power in re.findall(r"([A-Za-z%]+)(-?[\d.]+)?", units):
        exponent = abs(float(power or 1))
        text = name.replace("degree", "deg") + (
            "" if exponent == 1 else "²" if exponent == 2 else f"^{exponent:g}"
        )
        (denominator if (power or "").startswith("-") else numerator).append(text)
    return (" ".join(numerator) or "1") + ("/" + "/".join(denominator) if denominator else "")


def number(value: float, digits: int = 3) -> str:
    """Write a number as text: `0.0618`, `−2.5`, `1.2 × 10⁹`; digits: most significant digits."""
    mantissa, is_power, exponent = f"{value + 0.0:.{digits}g}".partition("e")  # no -0
    if is_power and 0 < int(exponent) < 5:  # 120 with two digits
        mantissa = f"{float(mantissa + is_power + exponent):.0f}"
    elif is_power:
        head = "" if mantissa == "1" else f"{mantissa} × "
        mantissa = f"{head}10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    return mantissa.replace("-", "−")


def quantity(value: float | None, units: str, digits: int = 3, missing: str = "unknown") -> str:
    """Write a number with its unit as text, such as `2.5 m/s`; units: as in files (`m s-1`);
    digits: most significant digits; missing: the text where value is None."""
    return missing if value is None else with_unit(number(value, digits), units)


def with_error(value: float, error: float | None, units: str, digits: int = 1) -> str:
    """Write a number with its error, both rounded to so many digits of the error: `0.062 ± 0.005
    m/s`; units: of both, as in files (`m s-1`). The number alone, with three digits, where the
    error is None, 0 or below a thousandth of it."""
    if not error or error < 1e-3 * abs(value):
        return quantity(value, units)
    places = digits - 1 - _power(error)
    text = [f"{v:z.{places}f}" if 0 <= places <= 9 else number(v, digits) for v in (value, error)]
    return with_unit(" ± ".join(text).replace("-", "−"), units)


def with_unit(text: str, units: str) -> str:
    """Put a unit behind a number's text: `2.5 m/s`; units: as in files (`m s-1`, `1`: none)."""
    return text if pretty(units) == "1" else f"{text} {pretty(units)}"


def percent(share: float) -> str:
    """Write a fraction in per cent, whole or, below 1 %, with two digits: `7 %`, `0.0002 %`."""
    return f"{number(100 * share, 2) if abs(share) < 0.01 else round(100 * share)} %"


def share(share: float, open_: float = 0.0) -> str:
    """Write a share of the box's volume in per cent with its uncertainty, never rounded to all or
    nothing: `81 ± 2 %`, `at least 98 %`, `an unknown share`. open_: half-width of its uncertainty,
    rounded up to one digit, above 10 per cent to a whole number; left out below 0.05 per cent and a
    tenth of what is missing to all or nothing: `81.25 %`."""
    percent, half_width = 100 * share, 100 * open_
    if half_width < min(OPEN, max(min(percent, 100 - percent), 0.01) / 10):
        if 0 < percent < 0.01 or 99.99 < percent < 100:
            return "less than 0.01 %" if percent < 50 else "more than 99.99 %"
        return f"{percent:.2f}".rstrip("0").rstrip(".") + " %"
    places = max(0, -int(np.floor(np.log10(half_width))))
    least = 10.0**-places
    half_width = np.ceil(half_width / least - 1e-9) * least
    if percent + half_width >= 100 and percent - half_width < least:
        return "an unknown share"
    if percent + half_width >= 100:
        return f"at least {np.floor((percent - half_width) / least + 1e-9) * least:.{places}f} %"
    if percent - half_width <= 0:
        return f"at most {np.ceil((percent + half_width) / least - 1e-9) * least:.{places}f} %"
    return f"{percent:.{places}f} ± {half_width:.{places}f} %"


VOLUME = "by volume, not a probability"  # what stands once beside shares of the box
OPEN = 0.05  # per cent of the box from which it is said how large the error of a share may be


def interval(row: Mapping[str, Any]) -> str:
    """Write a quantity's interval (its dict) with its unit, `0.31 to 0.34 s`; "" where there is
    none, and `0.31 to more than 2 s (the end of the runs)` of a time that some runs do not reach.
    may_be_endless: whether to say that a time may have no upper end.
    Both bounds are rounded to the place of the first digit of their error, or of a tenth of their
    difference if that is less; never more than two places beyond the first digit of their
    difference."""
    if row["lower"] is None:
        return ""
    first, last = ends(row)
    if row.get("censored_at"):
        most = quantity(row["censored_at"], row["units"])
        return f"{first} to more than {most} (the end of the runs)"
    text = with_unit(f"{first} to {last}", row["units"])
    return f"{text} (it may have no upper end)" if row.get("may_be_endless") else text


def ends(row: Mapping[str, Any]) -> list[str]:
    """Write both bounds of a quantity's interval (its dict), as `interval` does, without unit."""
    lower, upper = row["lower"], row["upper"]
    error, width = row.get("error") or 0.0, upper - lower
    size = max(abs(lower), abs(upper))
    places = -_power(width or 1e-3 * size or 1.0) + 2
    if error > 0 < width:
        places = min(places, -_power(min(error, width / 10)))
    if 0 <= places <= 9:
        return [f"{x:z.{places}f}".replace("-", "−") if x else "0" for x in (lower, upper)]
    return [number(x, max(1, min(9, places + 1 + _power(size)))) for x in (lower, upper)]


def _power(value: float) -> int:
    """Return the power of ten of a number's first digit."""
    return int(np.floor(np.log10(value)))


def place(values: Mapping[str, float | None], parameters: Iterable[Mapping[str, Any]]) -> str:
    """Write parameter values by name, such as `k = 2.5 N/m, L = 1 m`; None is left out."""
    units = {parameter["name"]: parameter["units"] for parameter in parameters}
    values = {name: value for name, value in values.items() if value is not None}
    return ", ".join(f"{name} = {quantity(values[name], units[name], 4)}" for name in values)


def spread(parameter: Mapping[str, Any]) -> str:
    """Write the interval of a parameter (its dict): `± 1 %` of its nominal value (of angles `± 2°`)
    if that is the middle, else both bounds, `1 to 2 m`."""
    nominal, units = parameter["nominal"], parameter["units"]
    below_nominal, above_nominal = nominal - parameter["lower"], parameter["upper"] - nominal
    if abs(above_nominal - below_nominal) < 1e-6 * abs(nominal):
        if unit := _ANGLES.get(units):  # a share of an angle says little
            return f"± {number(above_nominal)}{unit}"
        return f"± {number(100 * above_nominal / abs(nominal), 2)} %"
    return f"{number(parameter['lower'], 4)} to {quantity(parameter['upper'], units, 4)}"


def escape_text(text: str, code: str = "") -> str:
    """Escape a text from outside, such as a name, as one line that Markdown and terminals show
    unchanged; code: characters not to escape, such as a backtick."""
    line = "".join(sign for sign in " ".join(text.split()) if sign.isprintable())
    return line.translate({ord(sign): f"\\{sign}" for sign in "|<>`*[]\\&~$" if sign not in code})


def code(name: str) -> str:
    """Put a name between backticks, as code in Markdown, unless it has signs with a meaning."""
    return f"`{name}`" if re.fullmatch(r"\w[\w.-]*", name) else name


def tie_units(text: str, units: Iterable[str]) -> str:
    """Replace spaces of a text by no-break spaces between numbers and their units, signs, powers of
    ten or names (`k = 2`), and hyphens before numbers by minus signs. units: besides s, rad, %."""
    units = sorted(units, key=len, reverse=True)  # `N m s/rad` before `N m`
    pattern = "|".join(sorted(map(re.escape, {*units, "s", "rad", "%"}), key=len, reverse=True))
    text = re.sub(rf"(?<=[\d⁰-⁹]) (?=(?:{pattern})(?!\w))", _NO_BREAK, text)
    for unit in units:
        text = text.replace(_NO_BREAK + unit, _NO_BREAK + unit.replace(" ", _NO_BREAK))
    text = re.sub(r" = (?=[\d−-])", f"{_NO_BREAK}={_NO_BREAK}", text)
    text = re.sub(r"(?<![\w)-])-(?=\d)", "−", text)
    return re.sub(r"(?<=[\d±]) (?=[\d×])|(?<=\d) (?=±)|(?<=×) (?=10)", _NO_BREAK, text)


def to_html(text: str, units: Iterable[str] = ()) -> Any:
    """Turn a sentence into HTML (`markupsafe.Markup`): escaped, what stands between backticks as
    `<code>`, and no-break spaces between numbers and units. units: spellings such as `m/s`."""
    from markupsafe import Markup, escape

    text = tie_units(str(escape(text)), units)
    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", text))


def position(row: Mapping[str, Any], time: float) -> str:
    """Write a time (s) with its unit, or for a response over another axis, such as a hinge's
    opening, the value on that axis. row: the response's dict in `summary.json` (`facts_of`)."""
    if axis := row.get("along"):
        length = axis["last"] - axis["first"]
        return quantity(axis["first"] + length * time / axis["duration"], axis["unit"], 4)
    return quantity(time, "s", 4)


def duration_text(seconds: float) -> str:
    """Write a duration (s): 35 as `35 s`, 95 as `1 min 35 s`, 7500 as `2 h 5 min` (no seconds)."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def size_text(size: float) -> str:
    """Write a number of bytes in kB, MB or GB (powers of 1000): `5.5 MB`."""
    for unit in ("kB", "MB"):
        size /= 1000
        if size < 1000:
            return f"{size:.2g} {unit}" if size < 10 else f"{size:.0f} {unit}"
    return f"{size / 1000:.3g} GB"
