"""Every command and snippet of README and docs is right, and is run but for what `NOT_RUN` and
`ONLY_CHECKED` name."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
import xarray
import yaml

import campaign
from campaign.cli import _parser, main
from campaign.config.check import load_config
from campaign.stages import STAGES
from evidence.registry import STUDIES
from fpm import structures
from fpm.structures import report

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if "made" not in page.parts]
_BLOCK = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.M | re.S)

# What is not run here, by how it begins, and why; where a test elsewhere runs it, that is named.
NOT_RUN = {
    "git clone": "there is no address",
    "cd deployable-intervals": "goes with git clone",
    "python3 -m venv": ".ci/run makes an environment",
    "python3.11 -m venv": "of a peer, which is not installed here",
    ". .venv/bin/activate": ".ci/run makes an environment",
    "pip install": ".ci/run installs the program",
    "pre-commit": ".ci/run gives its commands one by one",
    "pytest": "these are the tests",
    ".ci/run": "runs these tests",
    "sphinx-build": "tests/docs/test_site.py builds the site",
    "EXUDYN_PYTHON=": "a peer, which is not installed here",
    "exudyn/bin/pip install": "a peer, which is not installed here",
    "elastica/bin/pip install": "a peer, which is not installed here",
    "python -m fpm.structures.table": "tests/structures/test_structures_page.py makes the table",
    "python -m campaign attack": "an hour; tests/attack gives each attack once",
    "python -m evidence": "minutes, or hours; tests/evidence runs parts of the studies",
    "snakemake": "tests/workflow runs Snakemake; CAMPAIGNS tells of each config",
}

# Where each campaign of the pages is run: here (by `python -m campaign run`, which makes the same
# files as Snakemake), or by another test.
CAMPAIGNS = {
    "mast": "here", "closing": "here", "deploys": "here", "first": "here",
    "small": "tests/golden/values.json", "paper": "tests/golden/values.json",
    "three": "tests/golden/values.json", "six": "tests/golden/values.json",
    "aim": "tests/workflow/test_campaign_runs.py",
}  # fmt: skip
# Only checked: the scans make 10,000 runs each, and the others take three minutes of a core in all,
# with the time loops that they compile.
ONLY_CHECKED = {
    "scan", "strength_scan",
    "array", "auto", "boom", "ring_truss", "strength", "telescope", "tensegrity",
}  # fmt: skip


def blocks(page, *languages):
    """The listings of a page in one of these languages."""
    found = _BLOCK.findall(page.read_text(encoding="utf-8"))
    return [text for _, language, text in found if language in languages]


def commands(page):
    """The lines of listings that begin with a known program, and those in running text."""
    text = page.read_text(encoding="utf-8")
    listed = "\n".join(blocks(page, "", "sh")).replace("\\\n", " ")
    lines = [line.split(" #")[0].strip() for line in listed.splitlines()]
    lines += re.findall(r"`((?:python -m|snakemake) [^`\n]+)`", text)
    found = [part.strip() for line in lines for part in line.split("&&")]
    return sorted(
        {line for line in found if re.match(r"(python|snakemake|pip|git|pytest)\b", line)}
    )


CASES = [(page, line) for page in PAGES for line in commands(page)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder like the program's, with the results of a small campaign, which those of others
    stand for."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("config", "docs", "Snakefile", "workflow"):
        (folder / name).symlink_to(ROOT / name)
    for name in PAGE_OF:
        for text in blocks(ROOT / "docs" / f"{PAGE_OF[name]}.md", "yaml"):
            kind = "campaign" if text.startswith("campaign:") else "structure"
            (folder / FILES[name, kind]).write_text(text, encoding="utf-8")
    quietly = {"figures": False, "tell": lambda text: None}
    campaign.run(ROOT / "config/small.yaml", folder / "results", **quietly)
    for other in ("paper", "first"):
        (folder / "results" / other).symlink_to(folder / "results/small")
    return folder


PAGE_OF = {"first": "first-campaign", "mine": "own-structure", "ladder": "step-ladder"}
FILES = {
    ("first", "campaign"): "first.yaml", ("mine", "structure"): "mine.yaml",
    ("mine", "campaign"): "my-campaign.yaml", ("ladder", "structure"): "ladder.yaml",
    ("ladder", "campaign"): "my-ladder.yaml",
}  # fmt: skip


def _marks(line):
    """Slow is what simulates a structure of its own."""
    simulates = re.match(r"python -m campaign export (config/mast|config/structures|mine)", line)
    return [pytest.mark.slow] * bool(simulates)


@pytest.mark.parametrize(
    ("page", "line"),
    [pytest.param(*case, marks=_marks(case[1])) for case in CASES],
    ids=[f"{p.stem}: {c}" for p, c in CASES],
)
def test_a_command_can_be_given(page, line, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    if line.startswith(tuple(NOT_RUN)) and not line.startswith("snakemake"):
        return
    words = shlex.split(line)
    if words[0] == "snakemake":
        _check_snakemake(words[1:])
    else:
        assert words[:3] == ["python", "-m", "campaign"], line
        _check_campaign(words[3:])


def _check_snakemake(words):
    options = {"--configfile", "--report", "--force", "--unlock", "--config", "--cores"}
    for word, value in zip(words, [*words[1:], ""], strict=True):
        assert not word.startswith("--") or word in {*options, "--forcerun", "--dry-run"}, word
        if word == "--configfile" and value != "my.yaml":
            load_config([value])
    before = dict(zip(words[1:], words, strict=False))
    for target in words:
        if not target.startswith("-") and not before.get(target, "").startswith("--"):
            assert target in STUDIES or Path(target).is_file() or target == "benchmark", target


def _check_campaign(words):
    """Run it, but for a form, a file that the reader is to write, and campaigns, which
    `test_a_campaign_of_the_pages_runs`."""
    if any(word.isupper() or "|" in word or "<" in word for word in words):
        return  # a form, not a command
    if len(words) == 1 and words[0] != "keys":
        assert words[0] in {"new", "check", "run", "structure", "export", *STAGES}
        return  # a name, not a command
    words = [w for w in words if w != ">" and not w.startswith("docs/")]
    if words[0] == "attack":  # has its own parser
        with pytest.raises(SystemExit) as ended:
            main([*words, "--help"])
        assert ended.value.code == 0
    elif words[0] == "run" or any(word in ("my.yaml", "mast.yaml") for word in words):
        _parser().parse_args(words)
    else:
        if words[0] == "new":  # several pages fill the same folder
            shutil.rmtree(words[1], ignore_errors=True)
        assert main([*words, *(["--frames", "3"] if words[0] == "export" else [])]) == 0


def _config_of(line):
    """Which campaign a command runs, by the name of its file; None if it runs none."""
    found = re.search(r"(?:--configfile|campaign run) (?:config/)?(\w+)\.yaml", line)
    if found or not re.match(r"snakemake -c\d+( --config .*)?$", line):
        return found and found[1]
    return "paper"


def test_it_is_known_where_each_campaign_of_the_pages_is_run():
    asked = {name for _, line in CASES if (name := _config_of(line))} - {"my"}
    assert asked == {*CAMPAIGNS, *ONLY_CHECKED}
    for name, where in CAMPAIGNS.items():
        assert where == "here" or f'"{name}' in (ROOT / where).read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mast", "closing", "deploys"])
def test_a_campaign_of_the_pages_runs(name, folder, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(["run", f"config/{name}.yaml", "--no-figures"]) == 0
    told = (folder / "results" / name / "summary.md").read_text(encoding="utf-8")
    assert told.startswith(f"# {name}\n")


# A snippet that defines a class or a function of a kernel is a form; `named` is run.
SNIPPETS = [
    (page, text)
    for page in PAGES
    for text in blocks(page, "python")
    if "def " not in text or "open_mfdataset" in text
]


@pytest.mark.parametrize(
    ("page", "text"), SNIPPETS, ids=[f"{p.stem}: {t.splitlines()[0]}" for p, t in SNIPPETS]
)
def test_a_snippet_runs(page, text, folder, monkeypatch):
    monkeypatch.chdir(folder)
    if "open_mfdataset" in text:
        pytest.importorskip("dask", reason="not installed")
    text = text.replace('sel(response="angle")', "isel(response=0)")  # of the campaign stood for
    exec(compile(text, page.name, "exec"), {})


def test_the_structure_and_campaigns_of_the_pages_are_right(folder, monkeypatch):
    monkeypatch.chdir(folder)
    mine = structures.load("mine.yaml")
    assert report.mobility(mine.build()).degrees == 2
    for name in ("first.yaml", "my-campaign.yaml", "my-ladder.yaml"):
        assert load_config([name]).name == yaml.safe_load(Path(name).read_text())["campaign"]


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", text):
        if not target.startswith(("http", "made/")):
            assert (page.parent / target).exists(), target


@pytest.mark.slow
def test_the_answer_of_the_first_campaign_is_what_the_page_says(folder, monkeypatch):
    """Numbers in the text, and the closed form of a rigid panel, to 0.1 % (it bends a little)."""
    import numpy as np

    monkeypatch.chdir(folder)
    assert main(["run", "first.yaml", "--results", "other", "--no-figures"]) == 0
    with xarray.open_dataset("other/first/bounds.nc") as bounds:
        last = bounds.sel(response="angle").isel(time=-1).load()

    def angle(k, mass):
        return np.pi * (1 - np.cos(3 * np.sqrt(3 * k / (mass * (1 + 0.1**2 / 4)))))

    found = last["lower"].item(), last["upper"].item()
    np.testing.assert_allclose(found, [angle(0.095, 1.02), angle(0.105, 0.98)], rtol=1e-3)
    page = (ROOT / "docs/first-campaign.md").read_text(encoding="utf-8")
    assert f"{found[0]:.3f} and {found[1]:.3f} rad" in page
    assert (
        f"{angle(0.095, 1.02):.3f} rad with" in page
        and f"{angle(0.105, 0.98):.3f} rad with" in page
    )
