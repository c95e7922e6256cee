"""Templates over the facts of a campaign (`facts`), for the summary and the page."""

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from typing import Any

from deployable.campaign.config.own_runs import CONSTANT_TEXT
from deployable.campaign.provenance import program_digest
from deployable.campaign.results import facts
from deployable.campaign.results.response_bounds import COMPONENTS, LARGE
from deployable.campaign.text import negate, numbers
from fpm.kernels.sources import user_cache

_FOLDERS = [Path(__file__).parents[1] / room for room in ("results", "report", "cli")]


def environment(units: Iterable[str] = (), html: bool = False) -> Any:
    """Make a jinja2 environment of the templates of this folder, `report/` and `cli/`; html: of
    HTML, which is escaped, and in which `units` such as `m/s` stay on a line with their number."""
    import jinja2

    class CompiledTemplates(jinja2.FileSystemBytecodeCache):
        """Templates as code on disk: to make it takes longer than to render them."""

        def dump_bytecode(self, bucket: Any) -> None:
            with suppress(OSError):  # of a full disk, say
                super().dump_bytecode(bucket)

    @jinja2.pass_context  # so that no constant is finalized where a template is compiled
    def tie_units(_: Any, value: Any) -> Any:
        return numbers.tie_units(value, units) if type(value) is str else value

    # Filters of constants are part of what is compiled, and so all of the program.
    units, folder = list(units), user_cache() / "templates" / program_digest()
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_FOLDERS), autoescape=html,
        trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined,
        finalize=tie_units if html else None,
        bytecode_cache=CompiledTemplates(str(folder), f"{'html' if html else 'text'}-%s"),
    )  # fmt: skip
    filters = {
        numbers: ("number", "quantity", "percent", "share", "interval", "place", "spread", "pretty",
                  "position", "with_error", "with_unit", "code", "ends"),
        facts: ("decisive", "moments", "happens_only", "has_effect", "fitted_width", "scarcest",
                "is_tight", "missing_only", "largest", "changes", "best_halvings",
                "worst_case", "worst_limit", "roomier", "contact_bound"),
    }  # fmt: skip
    for module, names in filters.items():
        env.filters |= {name: getattr(module, name) for name in names}
    env.filters |= {
        "met_text": met_text, "doubts": doubts, "negate": negate,
        "capitalise": lambda text: text[:1].upper() + text[1:],
        "first_lower": lambda text: text[:1].lower() + text[1:],
        "coded": partial(numbers.to_html, units=units),
    }  # fmt: skip
    env.tests |= {
        "varying": facts.varies,
        "in_any": lambda part, rows: any(part in row["errors"] for row in rows),
    }
    env.globals |= {"SOFT": facts.SOFT, "COMPONENTS": COMPONENTS, "VOLUME": numbers.VOLUME}
    env.globals |= {"CONSTANT_TEXT": CONSTANT_TEXT, "LARGE": LARGE}
    return env


def summary_text(facts: Mapping[str, Any], template: str = "summary.md.jinja") -> str:
    """Render a template with the facts. Texts are escaped, except for backticks of `_SENTENCES`."""
    text = environment().get_template(template).render(facts=_escape(facts))
    return re.sub(r"\n{3,}", "\n\n", text).rstrip() + "\n"


_SENTENCES = ("doubt", "headline", "text")
"""Keys of texts that keep all backticks; others keep those about a name."""


def _escape(facts: Any, code: str = "") -> Any:
    """Escape facts and names in them, so that Markdown shows them literally; code: but for this."""
    if isinstance(facts, Mapping):
        return {
            _escape(key): _escape(value, "`" if key in _SENTENCES else "")
            for key, value in facts.items()
        }
    if isinstance(facts, list | tuple):
        return [_escape(item, code) for item in facts]
    if not isinstance(facts, str):
        return facts
    return re.sub(r"\\`(\w[\w.-]*)\\`", r"`\1`", numbers.escape_text(facts, code))


def met_text(row: Mapping[str, Any]) -> str:
    """Write in which part of the box a requirement, or one of its limits (`row`), is met: `All`,
    `None` or a percentage. If the share is not known, write that no run or every run fails."""
    if row["met"] == "undecided":
        return f"No failure found in {row['runs']} run{'s' * (row['runs'] != 1)}"
    if row["met"] == "some" and not row["share"] and row["share_uncertainty"] >= 1:
        return f"None of {row['runs']} run{'s' * (row['runs'] != 1)}"
    sure = row["met"] != "some" and 100 * row["share_uncertainty"] < numbers.OPEN
    text = row["met"] if sure else numbers.share(row["share"], row["share_uncertainty"])
    return text[0].upper() + text[1:]


def doubts(facts: Mapping[str, Any]) -> list[str]:
    """Write sentences that name the responses and quantities whose values do not follow from the
    model, one for each reason (`Experiment.doubts`)."""
    rows = (*facts["responses"], *facts["quantities"])
    return doubt_texts({row["name"]: row["doubt"] for row in rows if "doubt" in row})


def doubt_texts(doubts: Mapping[str, str]) -> list[str]:
    """Write sentences that name the responses and quantities that the model does not determine, one
    for each reason. doubts: the reason by name of response or quantity."""
    names: dict[str, list[str]] = {}
    for name, text in doubts.items():
        names.setdefault(text, []).append(name)
    return [
        f"The model does not determine {' and '.join(ids)}: {text}" for text, ids in names.items()
    ]


def sentence(name: str, *facts: Any, escapes: bool = True) -> str:
    """Text that a macro of `sentences.jinja` makes, for use outside of the templates; name: of the
    macro; facts: its arguments in order; escapes: whether texts in these are escaped."""
    return getattr(_macros(), name)(*(map(_escape, facts) if escapes else facts))


_macros = cache(lambda: environment().get_template("sentences.jinja").module)
