"""No name of a value or module is only a participle, a pronoun, a preposition or an adverb."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CLEAN = ("deployable", "evidence", "fpm")
"""Folders and files that are held to it."""

WORDS = """
it its one ones other others another each every both either neither any some none such this
that these those what which who whom whose him same several many few more less much enough
way ways thing things
of on at by to from in into onto with without within about above across after against along
among around as before behind below beneath beside besides between beyond but down during
except for inside near off outside over past per since through toward under until up upon via
out apart away aside back ahead
now then here there where when how why so too once twice again also always never ever only
just still yet already soon later earlier together alone far ago afterwards meanwhile
asked began begin begins begun bent borne built called came carried caught changed
chosen closed come counted crossed cut damaged done driven entered failed fixed followed
foreseen foretold found gathered given gone got grown had handed having held joined judged
jumped kept known led left lost made matched meant missed moved needed noted offered opened
passed placed pushed reached recorded refused removed required said seen settled shown shut
slid solved sought spun started stated stored strained stretched taken told touched tried
turned used wanted watched weighed wished written
being coming doing due ending going losing watching
own ours theirs mine instead inwards outward outwards hung broke partly nothing
nowhere somewhere was has ran won towards may fell late alike
unlike like amid blamed requiring lacking pursued finished agreeing
handed_on seen_by by_how_much told_so at_once of_all on_one about_one most_before held_by most_told
asked_of met drawn early further halfway spent spelt plus minus
"""
NEVER = frozenset(WORDS.split())
ALLOWED = {
    "fixed": "a joint that leaves no freedom",
    "evidence/attack/metamorphic/pairs.py:what": "a key of the lines of JSON that it prints",
    "evidence/rows.py:passed": "a key of rows in summary.json of studies",
    "deployable/intervals/scalars/surrogate.py:alone": "a variable of quantities.nc",
    "fpm/declare.py:above": "keyword of `number`, docs/mechanics.md",
    "deployable/campaign/results/review.py:met": "the verdict of a clause",
}
"""Terms of the field, with the reason; `path:name` allows it there."""

ENDING = re.compile(r"(?!(is|has|was|are|needs)_)\w*(ed|en|ings?)")
"""Names of what was done or is going on, if they are no statement: `rubbed`, `waiting`."""

_TERMS = """
nouns: bearing children codegen green len need red ring seed speed spring string swing
    bardamping tablespring token torsionspring
verbs of functions: flatten reopen tighten widen
plain English for the value: allowed expected fixed missing moving open squared
of a material, a contact, a joint: locked one_sided unstrained unstressed
of bounds (docs/terms.md): attained simulated unconverged undecided
keys of configs, rows and results: analysed halved measured normalized not_analysed passed
    published skipped trusted weighted
of numba: finalized linking
gerunds for what has come of it: bending ceiling closing crossing crowding damping docstring
    drawing encoding finding halving heading inlining kriging loading lumping mapping opening
    padding reading recording reopening rounding scaling screening setting settling spacing
    timing typing unloading warning
"""
TERMS = frozenset(_TERMS.split())
"""Names with this ending, or whose last word is one, that stay."""

MEMBERS = {
    "along": "key of margins, docs/responses.md; what a response lies along",
    "above": "exclusive lower bound of a number, docs/mechanics.md",
    "met": "key of plan.json and summary.json: whether an accuracy or a requirement is",
}
"""Names of the public interface, allowed for fields and methods and for functions of modules."""


def bindings(tree):
    """Node and name of everything that a module binds, imports without `as` left out."""
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
                yield node, name
            case ast.Attribute(attr=name, ctx=ast.Store()):
                yield node, name
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                yield node, name
            case ast.ClassDef(name=name) | ast.ExceptHandler(name=str(name)):
                yield node, name
            case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)):
                yield node, name
            case ast.MatchMapping(rest=str(name)):
                yield node, name
            case ast.Import(names=aliases) | ast.ImportFrom(names=aliases):
                yield from ((node, alias.asname) for alias in aliases if alias.asname)


def members(tree):
    """The nodes that bind fields, methods, attributes, and functions of the module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef):
            yield from (part for part in node.body if isinstance(part, ast.FunctionDef))
        if isinstance(node, ast.ClassDef):
            for part in node.body:
                yield from [part.target] if isinstance(part, ast.AnnAssign) else []
                yield from part.targets if isinstance(part, ast.Assign) else []
        if isinstance(node, ast.Attribute):
            yield node


def words(source, path=""):
    """Line and name of what a source binds, and of itself, if the word says nothing of it."""
    tree = ast.parse(source)
    tree.lineno, module = 1, Path(path.removesuffix("/__init__.py")).stem
    fields = {id(node) for node in members(tree)}
    for node, name in [(tree, module), *bindings(tree)]:
        bare = name.strip("_").rstrip("0123456789").casefold()
        allowed = {*ALLOWED, *(MEMBERS if id(node) in fields else ())}
        if bare in NEVER:
            is_wrong = not {bare, f"{path}:{bare}"} & allowed
        else:
            is_wrong = ENDING.fullmatch(bare)
            last = bare.rpartition("_")[2]
            is_wrong = is_wrong and not {bare, last, last.removesuffix("s")} & TERMS
        if is_wrong:
            yield node.lineno, name


def held_files():
    """Paths of the Python files that are held to it, from the root."""
    for entry in CLEAN:
        path = ROOT / entry
        assert path.exists(), entry
        files = path.rglob("*.py") if path.is_dir() else [path]
        yield from (file.relative_to(ROOT).as_posix() for file in files)


@pytest.mark.parametrize("entry", CLEAN)
def test_names_are_nouns_of_their_values(entry):
    wrong = [
        f"{path}:{line}:{name}"
        for path in sorted(held_files())
        if path == entry or path.startswith(f"{entry}/")
        for line, name in sorted(words((ROOT / path).read_text("utf-8"), path))
    ]
    assert not wrong, "\n" + "\n".join(wrong)


PLANTED = {
    "found = 1": "found",
    "NOW = 1": "NOW",
    "_given, before2 = 1, 2": "_given before2",
    "def here(it, *, told=1, **others): pass": "here it told others",
    "f = lambda at: at": "at",
    "class Held:\n    known: int\n    above = watched = 1\n    along: int": "Held known watched",
    "self.left, self.along = 1, 2": "left",
    "def along(): shut = 1": "shut",
    "for one in x: pass": "one",
    "with x as this: pass": "this",
    "y = [both for both in x]": "both",
    "(seen := 1)": "seen",
    "import x as there": "there",
    "try: pass\nexcept X as what: pass": "what",
    "match x:\n    case {'a': [such, *those], **on}: pass": "such those on",
    "type_name = found_rows = x.found": "",
    "rubbed, _Tied2, rows_taken = x": "rubbed _Tied2 rows_taken",
    "waiting = time_waiting = x.waiting": "waiting time_waiting",
    "class Kept:\n    hidden: int\n    is_hidden: bool\n    simulated: float": "Kept hidden",
    "def widen(speed, normalized, *, tilted_axes, bearings): pass": "",
}


@pytest.mark.parametrize("source", PLANTED)
def test_a_planted_name_is_reported(source):
    assert sorted(name for _, name in words(source)) == sorted(PLANTED[source].split())
    assert [*words("", "fpm/moved/__init__.py")] == [(1, "moved")]


def test_words_that_are_allowed_are_of_the_list():
    assert {key.rpartition(":")[2] for key in (*ALLOWED, *MEMBERS)} <= NEVER
