"""What is told before and while a campaign runs."""

from __future__ import annotations

import io
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.answers.estimate import _duration, estimate
from deployable.campaign.runs.progress import (
    MessagePrinter,
    progress_of,
    warm_up,
)
from deployable.campaign.text.numbers import duration_text, size_text
from fpm import structures
from fpm.scenes.timestep import compile_seconds

CONFIG = Path(__file__).parents[2] / "config"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def now(monkeypatch):
    """The time (s), in a list so that it can be changed."""
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    return now


def test_on_a_terminal_progress_is_one_line_that_moves_and_in_a_log_there_is_news(now):
    terminal, file = Terminal(), io.StringIO()
    notify = MessagePrinter(terminal, file)
    notify("plan")
    for state in ("1 of 3", "2 of 3"):
        now[0] += 3.0
        notify.move(state)
    notify("bounds")
    clear = "\r\x1b[2K"
    assert terminal.getvalue() == f"plan\n{clear}1 of 3{clear}2 of 3\nbounds\n"
    assert file.getvalue() == "plan\n2 of 3\nbounds\n"


def test_a_message_goes_below_a_line_that_has_not_ended():
    terminal = Terminal()
    notify = MessagePrinter(terminal)
    notify.move("1 of 3")
    notify("compiling")
    assert terminal.getvalue().endswith("1 of 3\ncompiling\n")


def test_a_line_that_moves_is_no_wider_than_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "10")
    terminal = Terminal()
    MessagePrinter(terminal).move("x" * 50)
    assert terminal.getvalue().endswith("K" + "x" * 9)


@pytest.mark.parametrize("hours", [0.05, 10.0])
def test_a_log_is_silent_for_20_s_at_most_or_a_tenth_of_the_time(now, hours):
    told = []
    notify, start = MessagePrinter(lambda text: told.append(now[0] - start)), now[0]
    while now[0] < start + 3600 * hours:
        notify.move(f"{now[0]}")
        now[0] += 1.0
    pauses = np.diff(told)
    assert told[0] == 5.0 and (pauses >= 20.0).all() and len(told) < 100
    assert (pauses <= np.maximum(20.0, np.array(told[:-1]) / 10 + 1.0)).all()


def test_the_line_tells_how_many_runs_are_done_and_how_long_it_will_take():
    done = [10]
    describe = progress_of("mast", 110, lambda: done[0])
    done[0] = 30
    assert describe(20.0) == "mast: 30 of 110 runs done, about 1 min 20 s left"
    done[0] = 110
    assert describe(100.0) == "mast: 110 of 110 runs done"


@pytest.fixture
def ticks(monkeypatch):
    """Looks at a step come at once, so does what a log is told."""
    monkeypatch.setattr("deployable.campaign.runs.progress.TICK", 0.01)
    monkeypatch.setattr("deployable.campaign.runs.progress.FIRST", 0.0)


@pytest.mark.parametrize(
    "stage", ["bounds", "answers", "figures", pytest.param("page", marks=pytest.mark.slow), "plan"]
)
def test_a_stage_says_what_it_does_while_it_works(raw, tmp_path, monkeypatch, ticks, stage):
    """Of each a step takes long here."""
    slow = {
        "plan": "stages.plan.make_plan",
        "bounds": "stages.bounds.analyse",
        "answers": "stages.answers.summarise",
        "figures": "stages.figures.envelope",
        "page": "stages.page.make_motions",
    }[stage]

    class Reached(Exception): ...

    def wait(*rest, **options):
        time.sleep(0.1)
        raise Reached

    told = []
    monkeypatch.setattr(f"deployable.campaign.{slow}", wait)
    with pytest.raises(Reached):
        campaign.run(raw, tmp_path, notify=told.append)
    assert told[-1].startswith(f"{raw['campaign']}: ") and told[-1].endswith(" s")


def test_ctrl_c_says_what_is_there_and_how_to_go_on():
    code = """if True:
        import os, signal, sys, time
        from deployable.campaign.runs.progress import progress_of, report_step
        from deployable.campaign.runs.progress import end_on_ctrl_c
        signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
        end_on_ctrl_c()
        with report_step(progress_of("mast", 9, lambda: 4), print):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(60)
    """
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60
    )
    assert ended.returncode == 130
    assert ended.stderr == (
        "stopped at: mast: 4 of 9 runs done; what is finished is kept, the same command goes on "
        "from there\n"
    )


@pytest.mark.slow
@pytest.mark.parametrize("keep", ["trajectories", "responses"])
def test_the_disk_space_told_is_what_is_used(raw, tmp_path, keep):
    """To 30 %: enough to know whether it fits."""
    raw["solver"] = {"duration": 0.01, "instants": 3001}
    raw["jobs"] |= {"keep": keep}
    told = estimate(campaign.check_config(raw))
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    used = sum(path.stat().st_size for path in tmp_path.rglob("*.nc"))
    assert told.bytes == pytest.approx(used, rel=0.3)
    assert told.runs == 6


def test_the_time_told_grows_with_runs_and_steps(raw):
    few = estimate(campaign.check_config(raw))
    raw["design"] = {"method": "sobol", "samples": 100_000}
    raw["solver"] |= {"duration": 10.0}
    many = estimate(campaign.check_config(raw))
    assert few.seconds - few.compile_time < 10 and "min" not in str(few)
    assert many.seconds > 100 * (few.seconds - few.compile_time) and " min " in str(many)


@pytest.mark.parametrize("kinds", [[], [None]])
def test_the_time_told_is_with_that_to_compile_where_that_is_to_be_done(raw, monkeypatch, kinds):
    monkeypatch.setattr("fpm.list_kinds_to_compile", lambda *rest: kinds)
    seconds = compile_seconds(kinds)
    found = estimate(campaign.check_config(raw))
    assert found.compile_time == seconds
    assert ("of it to compile, once" in str(found)) == (seconds > 0)
    assert seconds < found.seconds < seconds + 10


def test_progress_is_told_while_something_compiles(monkeypatch, ticks):
    monkeypatch.setattr("fpm.warm_up", lambda scene, record: time.sleep(0.1))
    monkeypatch.setattr("fpm.list_kinds_to_compile", lambda scene, record: [None])
    told = []
    warm_up(structures.load(CONFIG / "structures/panel.yaml").build(), told.append)
    assert told and told[0] == "compiling for these kinds of element, once: 0 s of some 1"


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(0.2, 1.0), (7.44, 7.4), (12.3, 12.0), (123.0, 120.0), (1501.0, 1500.0), (87_654.0, 88_000.0)],
)
def test_times_are_told_to_two_digits_and_as_a_second_at_least(seconds, told):
    assert _duration(seconds) == duration_text(told)


def test_sizes_as_people_write_them():
    assert size_text(2345) == "2.3 kB"
    assert size_text(61.2e6) == "61 MB"
    assert size_text(4.81e9) == "4.81 GB"


def test_a_level_that_was_set_before_stays():
    """Also where the logger's module is imported afterwards, as `campaign.run` does."""
    code = (
        "import logging; logger = logging.getLogger('deployable'); logger.setLevel('WARNING');"
        "import deployable.campaign.runs.progress; raise SystemExit(logger.level)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 30
