#!/usr/bin/python3
"""Takes the pictures of the workbench in docs/pictures: opens it in tmux, does what a user would, draws what tmux captured.

Usage: tests/tui/screenshots.py [--out docs/pictures] SUNDER [NAME ...]     from the root of the repository
Needs tmux, python3-pil and fonts-dejavu-core. Each NAME is a function here; without names all of them are taken.
"""
import argparse
import os
import subprocess
import sys
import tempfile
import time

import terminal
import terminal_picture
from terminal import Failure, Screen

SHOTS = {}
SCENES = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenes"))
TUBE = f"run {SCENES}/solid/tube_pull.lua --set particles=12000 --tui"


class Shot:
    def __init__(self, function, width, height, start, library):
        self.function, self.width, self.height, self.start, self.library = function, width, height, start, library


def shot(width=120, height=36, start=TUBE, library=False):
    """Registers a function that brings a screen to where its picture is taken. start: the program's arguments; library: the workbench opens
    on its scenes, over a ledger of sixteen runs."""
    def register(function):
        SHOTS[function.__name__] = Shot(function, width, height, "" if library else start, library)
        return function
    return register


def do(screen, text):
    screen.keys(":")
    screen.wait(r"^:")
    screen.type(text)
    screen.keys("Enter")


def until(screen, frame):
    screen.wait(r"(running|paused) *$", "the run", patience=120)
    do(screen, f"run.run-to {frame}")
    screen.wait(rf"frame +{frame}/", f"frame {frame}", patience=900)
    screen.wait(r"paused *$", patience=60)


@shot(160, 50)
def workbench_run(screen):
    until(screen, 90)
    do(screen, "run.mode")
    do(screen, "run.histogram")
    do(screen, "run.knob eta")


@shot(80, 24)
def workbench_80x24(screen):
    until(screen, 90)
    screen.keys("n")


@shot(80, 24)
def workbench_knobs(screen):
    until(screen, 60)
    do(screen, "run.turn break_stretch=0.15")
    screen.wait("from the next frame on")


@shot(120, 36)
def workbench_cut(screen):
    until(screen, 80)
    do(screen, "run.mode")
    do(screen, "run.cut z")
    do(screen, "run.look front")
    do(screen, "run.panel damage")


@shot(140, 44)
def workbench_compare(screen):
    until(screen, 90)
    do(screen, "run.branch 60")
    screen.wait(r"frame +60/", patience=60)
    screen.wait(r"paused *$", patience=60)
    do(screen, "run.turn alpha=0")
    screen.wait("alpha = 0 from")
    until(screen, 90)
    do(screen, "screen compare")
    screen.wait("particles by")
    do(screen, "compare.frame 90")
    do(screen, "compare.mode")
    screen.wait(r"frame 90 .*frame 90", patience=60)


@shot(120, 36, start=f"run {SCENES}/sheet/paper_towel.lua --tui")
def workbench_sheet(screen):
    until(screen, 40)
    do(screen, "run.mode")


@shot(120, 36, start="")
def workbench_scenes(screen):
    screen.wait(r"\[Scenes\]")
    do(screen, "scenes.choose tube_pull")
    screen.wait(r"effects ─", patience=60)
    time.sleep(3)  # what it will cost is being measured


@shot(100, 30)
def workbench_console(screen):
    until(screen, 30)
    do(screen, "screen console")
    screen.wait(r"\[Console\]")
    for line in ("knob('eta')", "turn('eta', 0.2)", "measures().damage_max", "query('SELECT count(*) AS runs FROM runs')[1].runs", "help()"):
        screen.type(line)
        screen.keys("Enter")
        time.sleep(0.5)


@shot(100, 30)
def workbench_help(screen):
    until(screen, 10)
    screen.keys("?")
    screen.wait(r"^ *keys")


# A library of sixteen runs for the screens of past runs: a sweep over two parameters.
SWEEP = """return require("sunder").sweep {{
  title = "How it tears", scene = "{scenes}/solid/tube_pull.lua", frames = 36, set = {{ particles = 1500, pull = 0.4 }},
  over = {{ break_stretch = {{ 0.05, 0.1, 0.2, 0.3 }}, eta = {{ 0.05, 0.2, 0.45, 0.8 }} }},
}}
"""


@shot(140, 32, library=True)
def workbench_runs(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    do(screen, "runs.columns eta break_stretch broken_fraction damage_mean wall_s tags variant")
    do(screen, "runs.sort -broken_fraction")
    screen.keys("Space", "Space", "Space")


@shot(120, 36, library=True)
def workbench_plot(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Space", "Down", "Down", "Down", "Space", "Down", "Down", "Down", "Space")
    do(screen, "runs.plot broken_fraction")


@shot(120, 32, library=True)
def workbench_diff(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Space", "Space", "Space", "d")


@shot(100, 30, library=True)
def workbench_frames(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Enter")
    screen.wait("frame 0 of 36")
    do(screen, "runs.frame 30")


@shot(100, 30, library=True)
def workbench_sweep(screen):
    do(screen, "screen sweep")
    do(screen, "sweep.choose tearing.lua")
    screen.wait("16 done")
    screen.keys("Right", "Down")


@shot(120, 32, start="")
def workbench_stress(screen):
    screen.wait(r"\[Scenes\]")
    do(screen, "screen stress")
    screen.wait(r"not run")
    screen.wait(r"looking$", absent=True)
    do(screen, "stress.run broken cfl contrast crush directions domain inversion sheet_crumple")
    screen.wait("The hard cases have ended", patience=120)
    for _ in range(13):
        screen.keys("Down")


@shot(140, 36, start="")
def workbench_accuracy(screen):
    screen.wait(r"\[Scenes\]")
    do(screen, "screen accuracy")
    do(screen, f"accuracy.choose {os.path.abspath(SCENES)}/solid/tube_pull.lua --set particles=3000 --set break_stretch=0.1 --set pull=0.4 --threads 1 --frames 36")
    screen.wait(r"\[x\] resolution", patience=60)
    screen.keys("r")
    screen.wait("The study has ended", patience=300)
    screen.keys("Down")


def fill_library(sunder, home):
    """Makes the sixteen runs in the ledger of `home`, once for all pictures."""
    os.makedirs(f"{home}/sweeps", exist_ok=True)
    with open(f"{home}/sweeps/tearing.lua", "w", encoding="utf-8") as file:
        file.write(SWEEP.format(scenes=os.path.abspath(SCENES)))
    subprocess.run([sunder, "sweep", "sweeps/tearing.lua", "--threads", "1", "--quiet", "--db", f"{home}/ledger.db"], cwd=home, check=True,
                   env=dict(os.environ, XDG_DATA_HOME=home))


def take(sunder, name, out, library):
    chosen = SHOTS[name]
    terminal.PROGRAM = sunder
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as own:
        home = library if chosen.library else own
        variables = f"export XDG_DATA_HOME={home} XDG_CONFIG_HOME={home};{f' cd {home};' if chosen.library else ''}"
        with Screen(f"{chosen.start} --db {home}/ledger.db", width=chosen.width, height=chosen.height, variables=variables,
                    term="screen-256color") as screen:  # without bce: tmux does not capture cells that were erased in a colour
            if chosen.library:
                screen.wait(r"\[Scenes\]")
            chosen.function(screen)
            time.sleep(6)  # notices go
            path = os.path.join(out, f"{name}.png")
            terminal_picture.save(screen.tmux("capture-pane", "-p", "-e", "-N"), chosen.width, chosen.height, path)
            print(path, flush=True)
            screen.keys("Q")
            screen.wait("^status", patience=60)  # the run has left its folder


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sunder")
    parser.add_argument("--out", default="docs/pictures")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    sunder, names, failed = os.path.abspath(options.sunder), options.names or list(SHOTS), 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as library:
        if any(name in SHOTS and SHOTS[name].library for name in names):
            fill_library(sunder, library)
        for name in names:
            try:
                take(sunder, name, options.out, library)
            except (Failure, KeyError) as error:
                failed += 1
                print(f"{name}: {error}", file=sys.stderr)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
