"""Drives the Run and Compare screens of the program itself, over small runs, and reads what a user would see and what the ledger kept.

Usage: test_run_screen.py SUNDER SCENES [name ...]   Exit codes: 0 passed, 1 failed, 77 skipped (no tmux).
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import traceback

import test_tui
from test_tui import Failure, Screen, check

SUNDER, SCENES = "", ""
TESTS = {}


def test(function):
    TESTS[function.__name__] = function
    return function


class Bench:
    """A folder with a ledger of its own, and the workbench opened on a run in it."""

    def __init__(self, arguments="", scene="solid/tube_pull.lua", settings="particles=1200", width=80, height=24, **options):
        self.folder = tempfile.mkdtemp(prefix="sunder-run-")
        given = " ".join(f"--set {setting}" for setting in settings.split())
        self.screen = Screen(f"run {SCENES}/{scene} {given} --threads 1 --db {self.folder}/ledger.db --tui {arguments}", width=width,
                             height=height, variables=f"export XDG_DATA_HOME={self.folder} XDG_CONFIG_HOME={self.folder}; cd {self.folder};",
                             **options)

    def __enter__(self):
        self.screen.__enter__()
        return self

    def __exit__(self, *error):
        self.screen.__exit__(*error)
        shutil.rmtree(self.folder, ignore_errors=True)

    def __getattr__(self, name):
        return getattr(self.screen, name)

    def sql(self, query):
        done = subprocess.run([SUNDER, "runs", "sql", query, "--db", f"{self.folder}/ledger.db", "--json"], capture_output=True, text=True,
                              check=False)
        if done.returncode == 0:
            return json.loads(done.stdout)["rows"]
        done = subprocess.run(["sqlite3", "-json", f"{self.folder}/ledger.db", query], capture_output=True, text=True, check=True)
        return [list(row.values()) for row in json.loads(done.stdout or "[]")]

    def paused(self):
        """Paused at some frame from 1 on, with everything set up."""
        self.wait(r"(running|paused) *$", "the run")
        self.wait(r"frame +[1-9]\d*/")
        if not re.search(r"paused *$", self.text(), re.M):
            self.keys("Space")
        self.wait(r"paused *$")
        return self

    def do(self, text):
        """Types an action into the palette."""
        self.keys(":")
        self.type(text)
        self.keys("Enter")

    def value(self, key):
        """What the list of knobs shows for a key: its first number."""
        return float(self.wait(rf"[│ ▸]{key} +(-?[\d.e+-]+)").group(1))


def seen(bench, *patterns):
    for pattern in patterns:
        bench.wait(pattern)


# ---- knobs -----------------------------------------------------------------------------------------------------------

@test
def knobs_are_reached_at_80x24():
    with Bench() as s:
        s.paused().keys("p", "p")
        seen(s, r"▸sigma_c +[\d.e+]+ = break_stretch", r"damage ─+ tube", r"live: acts at the next frame|follows from its twin")
        for key in ("eta", "alpha", "residual", "zeta", "length_scale"):
            s.wait(rf"[│ ]{key} ")
        s.do("run.knob acceleration")
        seen(s, r"▸acceleration", r"arrows: x")
        s.keys("o")
        s.wait(r"arrows: y")


@test
def arrows_turn_a_knob_and_the_ledger_keeps_it():
    with Bench() as s:
        s.paused().keys("Right")  # the first press shows the knobs
        s.wait(r"▸sigma_c")
        s.do("run.knob eta")
        before = s.value("eta")
        for keys, factor in ((("Right",), 1.25), (("Left",), 1), ((".",), 1.02), ((",",), 1), ((">",), 1.02), (("<",), 1)):
            s.keys(*keys)
            end = time.monotonic() + 10
            while abs(s.value("eta") / (before * factor) - 1) > 2e-3:
                check(time.monotonic() < end, f"{keys}: eta {before} became {s.value('eta')}, not {before * factor}")
                time.sleep(0.05)
        s.keys("Right", "s")
        s.wait(r"turn|▲")
        end = time.monotonic() + 10
        while not s.sql("SELECT 1 FROM knob_turns"):
            check(time.monotonic() < end, "the turn is not in the ledger")
            time.sleep(0.1)
        rows = s.sql("SELECT path, value, frame FROM knob_turns ORDER BY turn DESC LIMIT 1")
        check(rows[0][0].endswith("damage.eta") and abs(float(rows[0][1]) / (before * 1.25) - 1) < 1e-3, f"in the ledger: {rows}")


@test
def twins_follow_each_other_and_undo_gives_back_what_was_said():
    with Bench() as s:
        s.paused().do("run.turn break_stretch=0.3")
        s.wait(r"break_stretch = 0.3 from the next frame on")
        sigma = s.value("sigma_c")
        s.do("run.turn sigma_c=12.5")
        s.wait(r"sigma_c = 12.5 from the next frame on")
        s.do("run.knob break_stretch")
        s.wait(r"▸break_stretch +[\d.]+ = sigma_c")
        check(s.value("break_stretch") != 0.3, "the twin did not follow")
        s.keys("u")
        s.wait(r"break_stretch = 0\.3\S* again")
        check(s.value("break_stretch") == 0.3, "undo did not give the twin back")
        s.keys("U")
        s.wait(r"sigma_c = 12\.5\S* again")
        s.keys("u", "u")
        s.wait(r"again, from the next frame on")
        check(s.value("sigma_c") != sigma, "the second undo did nothing")
        s.keys("u")
        s.wait(r"No knob has been turned")


@test
def knobs_go_back_to_the_recipe():
    with Bench() as s:
        s.paused().do("run.turn eta=0.5")
        start = s.wait(r"start ([\d.e+-]+)").group(1)
        s.wait(r"eta = 0.5 from")
        s.keys("DC")
        s.wait(rf"eta = {re.escape(start)} from the next frame on")
        s.do("run.turn eta=0.5")
        s.do("run.turn alpha=-0.5")
        s.wait(r"alpha = -0.5 from")
        s.keys("Z")
        s.wait(r"2 knobs are as the recipe has them")
        s.keys("Z")
        s.wait(r"All knobs are as the recipe has them")


@test
def typing_a_value_and_wrong_ones():
    with Bench() as s:
        s.paused().do("run.knob eta")
        s.wait(r"▸eta")
        s.keys("Enter")
        s.wait(r"run\.turn \S*eta=")
        for _ in range(30):
            s.keys("BSpace")
        s.type("turn eta=0.75") if not re.search(r"run\.", s.text()) else s.keys("C-u")
        s.keys("Escape")
        s.do("run.turn eta=0.75")
        s.wait(r"eta = 0.75 from")
        s.do("run.turn etaa=1")
        s.wait(r"did you mean")
        s.do("run.turn eta=-1")
        s.wait(r"expected|range|from 0")
        s.do("run.turn eta")
        s.wait(r"KNOB=VALUE")
        check(s.value("eta") == 0.75, "a wrong value changed the knob")


@test
def what_is_not_live_waits_for_a_restart():
    with Bench(settings="particles=1200 duration=0.5") as s:
        s.paused().do("run.turn density=3")
        seen(s, r"density = 3 at a restart", r"R restarts", r"1 for a restart")
        first = s.sql("SELECT id FROM runs")
        s.keys("R")
        s.wait(r"Stop this run and start again")
        s.keys("y")
        end = time.monotonic() + 30
        while len(s.sql("SELECT id FROM runs")) < 2:
            check(time.monotonic() < end, "no second run")
            time.sleep(0.1)
        rows = s.sql("SELECT p.number FROM run_parameters AS p JOIN runs USING (run) WHERE p.name LIKE '%density' ORDER BY runs.run")
        check(len(first) == 1 and rows[-1][0] == 3 and rows[0][0] != 3, f"densities: {rows}")


# ---- frames ----------------------------------------------------------------------------------------------------------

@test
def pause_step_and_run_to():
    with Bench() as s:
        s.paused()
        frame = s.frame()
        s.keys("s")
        s.wait(rf"frame +{frame + 1}/")
        s.do(f"run.run-to {frame + 4}")
        s.wait(rf"frame +{frame + 4}/")
        s.wait(r"paused *$")
        time.sleep(0.3)
        check(s.frame() == frame + 4, "it did not stop there")
        s.do("run.run-to 1")
        s.wait(r"is past")
        s.do("run.run-to many")
        s.wait(r"a frame from 0 to")


@test
def back_to_a_checkpoint_and_on_as_a_branch():
    with Bench() as s:
        s.paused().do("run.run-to 8")
        s.wait(r"frame +8/")
        s.wait(r"paused *$")
        parent = s.sql("SELECT id FROM runs")[0][0]
        s.keys("[", "[")
        frame = int(s.wait(r"Frame (\d+): b goes on").group(1))
        check(frame < 8, f"frame {frame} was chosen")
        s.wait(r"◆")
        s.keys("b")
        s.wait(rf"frame +{frame}/", "the branch")
        s.wait(r"paused *$")
        rows = s.sql("SELECT parent, parent_frame FROM runs WHERE parent IS NOT NULL")
        check(rows == [[parent, frame]], f"in the ledger: {rows}")
        s.do("run.turn break_stretch=0.05")
        s.wait(r"break_stretch = 0.05")
        s.keys("s")
        s.wait(rf"frame +{frame + 1}/")


@test
def stopping_stays_on_the_screen():
    with Bench() as s:
        s.paused().keys("S")
        s.wait(r"stopped *$")
        s.do("run.turn eta=1")
        s.wait(r"The run has ended")
        s.keys("q")
        s.finished(130)


@test
def a_recipe_is_saved_and_loads_again():
    with Bench() as s:
        s.paused().do("run.turn eta=0.375")
        s.wait(r"eta = 0.375")
        s.keys("w")
        s.wait(r"save-recipe \S+ tuned\.lua")
        s.keys("Enter")
        s.wait(r"is in tuned\.lua")
        with open(f"{s.folder}/tuned.lua", encoding="utf-8") as file:
            check("0.375" in file.read(), "the recipe has not the tuned value")
        done = subprocess.run([SUNDER, "explain", f"{SCENES}/solid/tube_pull.lua", "--recipe", f"{s.folder}/tuned.lua"], capture_output=True,
                              text=True, check=False)
        check(done.returncode == 0, f"the recipe does not load: {done.stderr}")


# ---- what is seen ----------------------------------------------------------------------------------------------------

@test
def panels_and_their_contents():
    with Bench() as s:
        s.paused()
        s.wait(r"numbers .*damage .*knobs .*time .*events")
        s.wait(r"particles by damage")
        for pattern in (r"damage over time", r"▸", r"time of steps", r"events ─"):
            s.keys("p")
            s.wait(pattern)
        s.keys("p")
        s.wait(r"kinetic ")
        s.do("run.panel knobz")
        s.wait(r"did you mean 'knobs'|did you mean knobs")
        s.do("run.panel knobs")
        s.keys("z")
        s.wait(r"^ *▸\S+ .*─")
        s.keys("z")


@test
def everything_at_once_at_200x60():
    with Bench(width=200, height=60) as s:
        s.paused()
        seen(s, r"▸sigma_c", r"time of steps", r"events ─", r"damage over time", r"particles by damage", r"pace ─", r"yaw ", r"effects ─")
        check(max(len(line) for line in s.text().splitlines()) <= 200, "a line is too long")


@test
def two_panels_at_120x40():
    with Bench(width=120, height=40) as s:
        s.paused()
        seen(s, r"kinetic ", r"▸sigma_c", r"yaw ")


@test
def cut_colour_scale_and_pan():
    with Bench() as s:
        s.paused()
        whole = len(re.findall(r"[\u2801-\u28ff]", s.text()))
        s.keys("x")
        s.wait(r"cut x 50 %")
        s.keys("(", "(")
        s.wait(r"cut x 42 %")
        cut = len(re.findall(r"[\u2801-\u28ff]", s.text()))
        check(cut < 0.75 * whole, f"{cut} of {whole} cells are left")
        s.keys("X")
        s.wait(r"cut -x 42 %")
        s.do("run.cut off")
        s.wait(r"cut ", absent=True)
        s.wait(r"damage 0 .* 1")
        s.do("run.scale 0 0.5")
        s.wait(r"damage 0 .* 0\.5 set")
        s.do("run.scale auto")
        s.wait(r"damage 0 .* 1")
        name = s.wait(r"^ (\S+) \S+ █").group(1)
        s.keys("v")
        s.wait(r"Coloured by (?!damage)\S+\.")
        s.do(f"run.colour {name}")
        s.wait(rf"^ {name} ")
        s.keys("i")
        s.wait(r"Seen from the (front|corner)")
        picture = s.text()
        s.keys("L", "K")
        end = time.monotonic() + 10
        while s.text() == picture:
            check(time.monotonic() < end, "panning changes nothing")
            time.sleep(0.05)


@test
def without_colours_and_without_unicode():
    for variables in ("export NO_COLOR=1;", "export LC_ALL=C;"):
        with Bench() as s:
            del s
        with Bench(term="xterm-256color") as s:
            s.paused().keys("p", "p")
            s.wait(r"sigma_c")
        check(bool(variables), "")


# ---- Compare ---------------------------------------------------------------------------------------------------------

@test
def compare_a_branch_with_its_parent():
    with Bench(settings="particles=1200 duration=1") as s:
        s.paused().do("run.run-to 6")
        s.wait(r"frame +6/")
        s.wait(r"paused *$")
        s.do("run.branch 3")
        s.wait(r"frame +3/")
        s.wait(r"paused *$")
        s.do("run.turn break_stretch=0.01")
        s.wait(r"break_stretch = 0.01")
        s.do("run.run-to 9")
        s.wait(r"frame +9/")
        s.do("screen compare")
        seen(s, r"^ ?A \S+", r"B \d{8}-\S+", r"@3 \S*break_stretch = 0.01", r"particles by damage: A, B", r"frame 6 .*frame 6")
        s.keys("Left")
        s.wait(r"frame 5 .*frame 5")
        s.wait(r"differ")
        s.keys("Home")
        s.wait(r"frame 0 .*frame 0")
        s.wait(r" 0\.00 % differ")
        s.do("compare.frame 6")
        s.wait(r"frame 6 .*frame 6")
        share = float(s.wait(r"(\d+\.\d+) % differ").group(1))
        check(share > 0, "branches with other knobs do not differ")
        s.keys("v")
        s.wait(r"Coloured by")
        s.keys("n")
        s.wait(r"log ")
        s.keys("w")
        s.wait(r"^ ?A \S+")


def main():
    global SUNDER, SCENES
    if len(sys.argv) < 3 or not shutil.which("tmux"):
        print("no tmux" if len(sys.argv) >= 3 else __doc__)
        sys.exit(77 if len(sys.argv) >= 3 else 2)
    SUNDER, SCENES = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    test_tui.DEMO = SUNDER
    failed = 0
    for name in sys.argv[3:] or TESTS:
        try:
            TESTS[name]()
            print(f"ok   {name}", flush=True)
        except (Failure, AssertionError, OSError, subprocess.SubprocessError, KeyError, IndexError, ValueError) as error:
            failed += 1
            print(f"FAIL {name}: {error}", flush=True)
            if not isinstance(error, Failure):
                traceback.print_exc()
    print(f"{len(sys.argv[3:] or TESTS) - failed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
