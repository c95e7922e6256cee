"""What is told before and while a campaign runs."""

from __future__ import annotations

import io
import time
from pathlib import Path

import pytest

import fpm
from deployable import campaign
from deployable.campaign.answers.estimate import _round, estimate
from deployable.campaign.runs.progress import MessagePrinter, Progress, warm_up
from deployable.campaign.text.numbers import size_text
from fpm import structures
from fpm.scenes.effort import compile_seconds

CONFIG = Path(__file__).parents[2] / "config"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_on_a_terminal_progress_is_one_line_that_moves():
    terminal, file = Terminal(), io.StringIO()
    notify = MessagePrinter(terminal, file)
    notify("plan")
    for state in ("1 of 3", "2 of 3", "3 of 3"):
        notify.move(state)
    notify.move("3 of 3", last=True)
    notify("bounds")
    clear = "\r\x1b[2K"
    assert (
        terminal.getvalue()
        == f"plan\n{clear}1 of 3{clear}2 of 3{clear}3 of 3{clear}3 of 3\nbounds\n"
    )
    assert file.getvalue() == "plan\n1 of 3\n2 of 3\n3 of 3\nbounds\n"


def test_a_message_goes_below_a_line_that_has_not_ended():
    terminal = Terminal()
    notify = MessagePrinter(terminal)
    notify.move("1 of 3")
    notify("compiling")
    assert terminal.getvalue().endswith("1 of 3\ncompiling\n")


@pytest.fixture
def now(monkeypatch):
    """The time (s), in a list so that it can be changed."""
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    return now


def test_the_line_tells_how_long_it_will_take(now):
    done, terminal = [10], Terminal()
    progress = Progress("mast", 110, lambda: done[0], MessagePrinter(terminal))
    now[0], done[0] = 120.0, 30  # one a second
    progress.report(last=False)
    assert terminal.getvalue().endswith("mast: 30 of 110 runs done, about 1 min 20 s left")
    now[0] += 0.5
    progress.report(last=False)
    assert terminal.getvalue().count("done") == 1
    done[0] = 110
    progress.report()
    assert terminal.getvalue().endswith("mast: 110 of 110 runs done\n")


def test_a_job_counts_what_all_have_done_since_it_began(now):
    done, told = [0], []
    first = Progress("mast", 100, lambda: done[0], told.append)
    now[0], done[0] = 150.0, 50  # one a second
    second = Progress("mast", 100, lambda: done[0], told.append)
    second.report(last=False)
    assert told == ["mast: 50 of 100 runs done"]
    now[0], done[0] = 160.0, 60
    first.report(last=False)
    second.report(last=False)
    assert told[1:] == ["mast: 60 of 100 runs done, about 40 s left"] * 2


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


@pytest.mark.parametrize("there", [True, False])
def test_the_time_told_is_with_that_to_compile_where_that_is_to_be_done(raw, monkeypatch, there):
    monkeypatch.setattr("fpm.is_compiled", lambda scene: there)
    found = estimate(campaign.check_config(raw))
    assert (found.compile_time == 0) == there
    assert ("of it to compile, once" in str(found)) != there
    assert found.compile_time < found.seconds < found.compile_time + 10


def test_a_time_loop_is_known_to_be_compiled_once_it_is(monkeypatch, tmp_path):
    scene = structures.load(CONFIG / "structures/panel.yaml").build()
    fpm.warm_up(scene)
    assert fpm.is_compiled(scene)
    monkeypatch.setattr("fpm.kernels.compiled_loop.cache_folder", lambda kinds: tmp_path)
    assert not fpm.is_compiled(scene)


def test_progress_is_told_while_something_compiles(monkeypatch):
    monkeypatch.setattr("fpm.warm_up", lambda scene, record: time.sleep(0.05))
    monkeypatch.setattr("deployable.campaign.runs.progress.PAUSE", 0.02)
    told = []
    warm_up(scene := structures.load(CONFIG / "structures/panel.yaml").build(), told.append)
    some = f"{compile_seconds(scene):.0f}"
    assert told and told[0] == f"compiling for these kinds of element, once: 0 s of some {some}"


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(0.2, 1.0), (7.44, 7.4), (12.3, 12.0), (123.0, 120.0), (1501.0, 1500.0), (87_654.0, 88_000.0)],
)
def test_times_are_told_to_two_digits_and_as_a_second_at_least(seconds, told):
    assert _round(seconds) == pytest.approx(told)


def test_sizes_as_people_write_them():
    assert size_text(2345) == "2.3 kB"
    assert size_text(61.2e6) == "61 MB"
    assert size_text(4.81e9) == "4.81 GB"
