"""Every command and snippet of README and docs is run, here or by the test that is named, but for
what `NOT_RUN` and `STUDIES_NOT_RUN` name, with the reason."""

import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray
import yaml

from deployable.campaign.cli import _parser, main
from deployable.campaign.config.check import load_config
from deployable.campaign.stages import STAGES
from evidence.__main__ import main as study
from evidence.__main__ import parse
from evidence.registry import STUDIES
from fpm import structures
from fpm.elements import Latch
from fpm.structures import report

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if "made" not in page.parts]
_BLOCK = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.M | re.S)

# Other programs' commands by how they begin: why they are not run here, or what runs them.
NOT_RUN = {
    "git clone": "there is no address",
    "cd ": "into what the command before has made",
    ". .venv/bin/activate": ".ci/run makes and takes an environment of its own",
    "python3 -m venv": ".ci/run makes and takes an environment of its own",
    "pip install -e": ".ci/run installs the program, with what it depends on",
    "pip install .": "tests/workflow/test_wheel.py installs a wheel",
    "pip install 'deployable-intervals[export]'": "tests have meshio, and one is without it",
    "pip install 'deployable-intervals[mjcf]'": "tests have mujoco, and some are without it",
    "pip install snakemake": "plugins, for tests/slurm and tests/workflow/test_storage.py",
    "pre-commit": "asks a network; .ci/run gives its three commands",
    "pytest": "these are the tests",
    ".ci/run": "runs these tests",
    "sphinx-build": ".ci/run and tests/docs/test_site.py build the site",
    "compliance-checker": "tests/campaign/test_conventions.py asks it, where it is installed",
    "apt-get": "needs root; tests/slurm run where that was done",
    # Exudyn is not installed here; tests/evidence run with it where it is.
    "python3.11 -m venv": "of Exudyn",
    "exudyn/bin/pip": "Exudyn",
    "EXUDYN_PYTHON=": "with Exudyn",
    "snakemake --profile profiles/slurm": "needs Slurm; tests/slurm run it where that is",
    "snakemake -c2 --default-storage": "needs a plugin, as tests/workflow/test_storage.py does",
    "python -m evidence attack": "an hour; tests/attack does a minute of it",
}

# Where each campaign of the pages is run. The other tests run it by `python -m deployable run`;
# tests/workflow shows that Snakemake leaves the same files, and runs `--report` and `--unlock`.
_TOLD, _GOLDEN = "tests/docs/test_answers_of_pages.py", "tests/golden/values.json"
_FLOW, _EXAMPLES = "tests/workflow/test_campaign_runs.py", "tests/campaign/test_examples.py"
CAMPAIGNS = {
    "first": "here", "second": "here", "my": "here", "my-campaign": "here",
    "aim": _FLOW, "paper": _TOLD,
    "small": _GOLDEN, "three": _GOLDEN, "six": _GOLDEN,
    "array": _TOLD, "boom": _TOLD, "closing": _TOLD, "deploys": _TOLD, "mast": _TOLD,
    "review": _TOLD, "ring_truss": _TOLD, "strength": _TOLD, "telescope": _TOLD,
    "tensegrity": _TOLD, "umbrella": _TOLD,
    # With 64 of their 10,000 runs, which take 5 and 16 minutes of a core.
    "scan": _TOLD, "strength_scan": _TOLD,
    "wing": "tests/campaign/test_cases.py",
    "hatch": _EXAMPLES, "spindle": _EXAMPLES, "winch": _EXAMPLES,
}  # fmt: skip

# Of the studies, those parts that a page runs alone and that take seconds are run here.
QUICK_PARTS = {"verification": {"45° bend"}}

# All else of them takes long; with its cpu time on a slow core, and the tests that run smaller
# ones. `snakemake NAME` calls `python -m evidence NAME`: tests/evidence/test_studies.py.
STUDIES_NOT_RUN = {
    "verification": "1 minute, and 2 to compile; coarser: tests/evidence/test_problems.py",
    "extremes": "2 minutes; some cases: tests/evidence/test_extremes.py",
    "accuracy": "1 minute; five choices: tests/evidence/test_accuracy.py",
    "tradeoff": "7 minutes, `asked-latch` 20 s",
    "measured": "20 minutes; a test: tests/campaign/test_measured.py",
    "search": "20 minutes; one mechanism: tests/evidence/test_search_study.py",
    "scaling": "1 minute",
    "calibration": "3 minutes; a coarse mesh: tests/evidence/test_calibration.py",
    "benchmark": "5 minutes; small: tests/evidence/test_benchmark.py",
}


def blocks(page, *languages):
    """The listings of a page in one of these languages."""
    found = _BLOCK.findall(page.read_text(encoding="utf-8"))
    return [text for _, language, text in found if language in languages]


PROGRAM = (
    r"(?:python[\d.]*|snakemake|pip|[\w/]+/bin/pip|git|pytest|pre-commit|sphinx-build|\.ci/run|"
    r"apt-get|compliance-checker|ncdump|[A-Z_]+=\S+)"
)


def commands(page):
    """The lines of listings that begin with a known program, and what does so in running text; a
    program alone is its name there."""
    text = page.read_text(encoding="utf-8")
    indented = re.findall(rf"^ {{4,}}({PROGRAM} .*)$", text, re.M)
    listed = "\n".join([*blocks(page, "", "sh", "text"), *indented]).replace("\\\n", " ")
    lines = [re.split(" #", line)[0].strip() for line in listed.splitlines()]
    inline = re.findall(rf"`({PROGRAM} [^`]+)`", _BLOCK.sub("", text))
    lines += [" ".join(found.split()) for found in inline]
    found = [part.strip() for line in lines for part in line.split("&&")]
    return sorted({line for line in found if re.match(rf"({PROGRAM}|cd|\.)( |$)", line)})


CASES = list({line: (page, line) for page in PAGES for line in commands(page)}.values())
"""Each command once, with a page that has it."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory, shipped):
    """A folder like the program's, with the results of a small campaign, which those of others
    stand for."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("config", "docs", "Snakefile", "workflow"):
        (folder / name).symlink_to(ROOT / name)
    for name in PAGE_OF:
        _save_listings(name, folder)
    models = ROOT / "evidence/benchmark/peers/models"
    (folder / "model.xml").symlink_to(models / "slider_crank.xml")
    (folder / "my.yaml").symlink_to(ROOT / "config/small.yaml")
    (folder / "mast.yaml").symlink_to(ROOT / "config/structures/scissor.yaml")
    shutil.copytree(shipped("small")[0], folder / "results/small")
    shutil.copytree(shipped("paper")[0], folder / "results/paper")
    for other in ("first", "second"):
        shutil.copytree(folder / "results/small", folder / "results" / other)
    return folder


def _save_listings(name, folder):
    """Save the files that a page asks its reader to save."""
    page = ROOT / "docs" / f"{PAGE_OF[name]}.md"
    for text in blocks(page, "yaml"):
        structure = yaml.safe_load(text).get("name")
        file = f"{structure}.yaml" if structure else CAMPAIGN_OF[name]
        (folder / file).write_text(text, encoding="utf-8")
    if name == "first":
        for old, new in SECOND.items():
            assert f"`{new}`" in page.read_text(encoding="utf-8") and text.count(old) == 1
            text = text.replace(old, new)
        (folder / "second.yaml").write_text(text, encoding="utf-8")


SECOND = {"campaign: first": "campaign: second", "relative: 0.05": "relative: 0.02"}
PAGE_OF = {"first": "first-campaign", "mine": "own-structure", "ladder": "step-ladder"}
CAMPAIGN_OF = {"first": "first.yaml", "mine": "my-campaign.yaml", "ladder": "my-ladder.yaml"}


def _marks(line):
    """Slow is what simulates a structure of its own, studies, and what asks Snakemake."""
    own = r"python -m deployable export (config/mast|config/structures|mine)"
    slow = re.match(f"{own}|python -m evidence [a-z]|snakemake .*runs_per_job", line)
    return [pytest.mark.slow] * bool(slow)


@pytest.mark.parametrize(
    ("page", "line"),
    [pytest.param(*case, marks=_marks(case[1])) for case in CASES],
    ids=[f"{p.stem}: {c}" for p, c in CASES],
)
def test_a_command_can_be_given(page, line, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    if line.startswith(tuple(NOT_RUN)):
        return
    words = shlex.split(line)
    if words[0] == "snakemake":
        _check_snakemake(words[1:])
    elif words[:3] == ["python", "-m", "evidence"]:
        _check_study(words[3:])
    else:
        assert words[:3] == ["python", "-m", "deployable"], line
        _check_campaign(words[3:])


def _check_snakemake(words):
    options = {"--configfile", "--report", "--force", "--unlock", "--config", "--cores"}
    for word, value in zip(words, [*words[1:], ""], strict=True):
        assert not word.startswith("--") or word in options, word
        if word == "--configfile":
            load_config([value])
    before = dict(zip(words[1:], words, strict=False))
    for target in words:
        if not target.startswith("-") and not before.get(target, "").startswith("--"):
            assert target in STUDIES, target
    if "runs_per_job" in " ".join(words):
        command = [sys.executable, "-m", "snakemake", "-n", *words, "--directory", os.getcwd()]
        told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        assert re.search(r"^simulate +8$", told, re.M), told


def _is_quick(words):
    """Whether all that a command measures, however it is written, takes seconds."""
    options, parts = parse(words)
    return set(parts) <= QUICK_PARTS.get(options.study, set())


def _check_study(words):
    """Run it, but for a form, and what takes long, of which it is known that it could be run."""
    if words[0].isupper() or not _is_quick(words):
        return
    assert study([*words, "--output", "study"]) == 0
    told = json.loads(Path("study/summary.json").read_text(encoding="utf-8"))
    assert told["rows"] and Path("study/table.md").stat().st_size > 500


def _check_campaign(words):
    """Run it, but for a form, and campaigns, of which `CAMPAIGNS` tells."""
    if any(word.isupper() or "|" in word or "<" in word for word in words):
        return  # a form, not a command
    if len(words) == 1 and words[0] != "schema":
        assert words[0] in {"new", "check", "run", "structure", "export", *STAGES}
        return  # a name, not a command
    words = [w for w in words if w != ">" and not w.startswith("docs/")]
    if words[0] == "run":
        _parser().parse_args(words)
    else:
        if words[0] == "new":  # several pages fill the same folder
            shutil.rmtree(words[1], ignore_errors=True)
        assert main([*words, *(["--frames", "3"] if words[0] == "export" else [])]) == 0


def _config_of(line):
    """Which campaign a command runs, by the name of its file; None if it runs none."""
    found = re.search(r"(?:--configfile|deployable run) (?:config/)?([\w-]+)\.yaml", line)
    if found:
        return found[1]
    return "paper" if re.match(r"snakemake -c\d+( --config .*)?$", line) else None


def test_it_is_known_where_each_campaign_of_the_pages_is_run():
    asked = {name for _, line in CASES if (name := _config_of(line))} - {"campaign"}
    assert asked == set(CAMPAIGNS)
    for name, where in CAMPAIGNS.items():
        text = (ROOT / where).read_text(encoding="utf-8") if where != "here" else name
        assert re.search(rf"\b{name}", text), where


def test_nothing_is_excused_that_no_page_asks_for():
    lines = [line for _, line in CASES]
    for begins in NOT_RUN:
        assert any(line.startswith(begins) for line in lines), begins
    asked = {word for line in lines for word in line.split() if line.startswith("snakemake")}
    studies = [shlex.split(line)[3:] for line in lines if line.startswith("python -m evidence ")]
    studies.remove(["attack", "--minutes", "60"])
    asked |= {words[0] for words in studies}
    assert set(STUDIES) == set(STUDIES_NOT_RUN) and set(STUDIES) <= asked
    told = [parse(words) for words in studies if not words[0].isupper()]
    for name, parts in QUICK_PARTS.items():
        assert parts <= {part for o, found in told if o.study == name for part in found}, name
    for reason in (*NOT_RUN.values(), *STUDIES_NOT_RUN.values()):
        assert all((ROOT / path).exists() for path in re.findall(r"tests/[\w/.]+", reason)), reason


@pytest.mark.parametrize(
    "command",
    ["benchmark", "benchmark --strict --only campaign", "verification --only '45° bend' pendulum",
     "verification --strict", "tradeoff --only asked-latch"],
)  # fmt: skip
def test_what_takes_long_is_known_by_what_a_command_runs(command):
    assert not _is_quick(shlex.split(command))
    assert _is_quick(["verification", "--strict", "--only", "45° bend"])


# A snippet that defines a class or a function of a kernel is a form; `named` is run.
SNIPPETS = [(page, text) for page in PAGES for text in blocks(page, "python") if "def " not in text]


@pytest.mark.parametrize(
    ("page", "text"), SNIPPETS, ids=[f"{p.stem}: {t.splitlines()[0]}" for p, t in SNIPPETS]
)
def test_a_snippet_runs(page, text, folder, monkeypatch):
    monkeypatch.chdir(folder)
    text = text.replace('sel(response="angle")', "isel(response=0)")  # of the campaign stood for
    exec(compile(text, page.name, "exec"), {})


def test_the_structure_and_campaigns_of_the_pages_are_right(folder, monkeypatch):
    monkeypatch.chdir(folder)
    mine = structures.load("mine.yaml")
    assert report.mobility(mine.build()).degrees == 2
    for name in ("first.yaml", "my-campaign.yaml", "my-ladder.yaml"):
        assert load_config([name]).name == yaml.safe_load(Path(name).read_text())["campaign"]


def test_the_drawer_of_the_page_is_caught_when_it_says(folder):
    """By the closed form for what is in the scene; that such latches catch then, tests/fpm show."""
    scene = structures.load(folder / "drawer.yaml").build()
    (spring,), (latch,) = scene.springs, Latch.find(scene)
    mass = scene.mass[~scene.fixed[:, :3].all(axis=1)].sum()
    rate = math.sqrt(spring.stiffness / mass)
    caught = math.acos(1 - latch.angle / spring.rest) / rate
    assert scene.hinges[spring.hinge].slides and spring.hinge == latch.hinge
    page = (ROOT / "docs/own-structure.md").read_text(encoding="utf-8")
    assert f"arccos(0.1/0.4)/ω = {caught:.3f} s" in page


def test_the_lines_that_answer_questions_are_right_together(tmp_path):
    """For the boom, which has such things under other names."""
    page = (ROOT / "docs/quantities.md").read_text(encoding="utf-8")
    table = page.split("## From a question to its lines")[1].split("## ")[0]
    config = {
        "campaign": "asked",
        "scene": {"file": str(ROOT / "config/structures/boom.yaml")},
        "solver": {"duration": 2.0, "instants": 1001},
        "intervals": {"mass": {"relative": 0.02}},
    }
    names = {"hinge": "root", "pin": "root_latch", "arm": "tube1.bar", "mast": "tube2.bar"}
    for section, lines in re.findall(r"`(responses|quantities|requirements): ([^`]+)`", table):
        for name, own in names.items():
            lines = re.sub(rf"(?<=[\s\[]){name}(?=[\]}},])", own, lines)
        config.setdefault(section, {}).update(yaml.safe_load(lines))
    assert len(config["quantities"]) == 9 and len(config["requirements"]) == 2
    path = tmp_path / "asked.yaml"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    assert load_config([path]).name == "asked"


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if not target.startswith(("http", "made/")):
            assert (page.parent / target).exists(), target


@pytest.mark.slow
@pytest.mark.parametrize("name", ["first", "mine"])
def test_a_reader_can_follow_a_page(name, tmp_path, monkeypatch):
    """Every command and snippet is run in order in an empty folder; campaigns that `CAMPAIGNS` has
    elsewhere are only loaded, such as that of will-it-latch, whose command is run there."""
    (tmp_path / "config").symlink_to(ROOT / "config")
    monkeypatch.chdir(tmp_path)
    _save_listings(name, tmp_path)
    page = ROOT / "docs" / f"{PAGE_OF[name]}.md"
    for _, language, text in _BLOCK.findall(page.read_text(encoding="utf-8")):
        if language == "python":
            exec(compile(text, page.name, "exec"), {})
        for line in text.splitlines() if not language else ():
            words = shlex.split(line, comments=True)
            if words[0] == "snakemake":
                _check_snakemake(words[1:])
            elif not line.startswith(tuple(NOT_RUN)):
                assert main(words[3:]) == 0, line
    if name == "first":
        _check_the_answer_of_the_first_campaign(page)


def _check_the_answer_of_the_first_campaign(page):
    """Numbers in the text, and the closed form of a rigid panel, to 0.1 % (it bends a little)."""
    import numpy as np

    with xarray.open_dataset("results/first/bounds.nc") as bounds:
        last = bounds.sel(response="angle").isel(time=-1).load()

    def angle(k, mass):
        return np.pi * (1 - np.cos(3 * np.sqrt(3 * k / (mass * (1 + 0.1**2 / 4)))))

    found = last["lower"].item(), last["upper"].item()
    np.testing.assert_allclose(found, [angle(0.095, 1.02), angle(0.105, 0.98)], rtol=1e-3)
    text = " ".join(page.read_text(encoding="utf-8").split())
    assert f"{found[0]:.3f} and {found[1]:.3f} rad" in text
    assert f"{angle(0.095, 1.02):.3f} rad with" in text
    assert f"{angle(0.105, 0.98):.3f} rad with" in text
