#!/usr/bin/python3
"""Takes the pictures of the workbench in docs/pictures: opens it in tmux, does what a user would, draws what tmux captured.

Usage: tests/tui/screenshots.py SUNDER [--out docs/pictures] [NAME ...]     from the root of the repository
Needs tmux, python3-pil and fonts-dejavu-core. Each NAME is a function here; without names all of them are taken.
"""
import argparse
import os
import subprocess
import sys
import tempfile
import time

import terminal_picture
import test_tui
from test_tui import Failure, Screen

SHOTS = {}
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenes")


def shot(width=120, height=36):
    """Registers a function that brings a screen to where its picture is taken."""
    def register(function):
        SHOTS[function.__name__] = (function, width, height)
        return function
    return register


def do(screen, text):
    screen.keys(":")
    screen.type(text)
    screen.keys("Enter")


def run(scene, *settings, more=""):
    given = " ".join(f"--set {setting}" for setting in settings)
    return f"run {SCENES}/{scene} {given} --tui {more}"


def until(screen, frame):
    screen.wait(r"frame +\d+/", "the run", patience=120)
    do(screen, f"run.run-to {frame}")
    screen.wait(rf"frame +{frame}/", f"frame {frame}", patience=600)
    screen.wait(r"paused *$", patience=60)


TUBE = run("solid/tube_pull.lua", "particles=20000")


@shot(160, 50)
def run_screen(screen):
    until(screen, 96)
    do(screen, "run.mode")
    screen.wait("Particles as blocks")
    do(screen, "run.histogram")
    do(screen, "run.knob eta")


@shot(80, 24)
def run_small(screen):
    until(screen, 90)


@shot(80, 24)
def run_knobs(screen):
    until(screen, 90)
    do(screen, "run.panel knobs")
    do(screen, "run.turn break_stretch=0.15")
    screen.wait("from the next frame on")


@shot(120, 36)
def run_cut(screen):
    until(screen, 80)
    do(screen, "run.mode")
    do(screen, "run.cut z")
    do(screen, "run.look front")
    do(screen, "run.panel damage")


@shot(140, 44)
def compare(screen):
    until(screen, 90)
    do(screen, "run.branch 60")
    screen.wait(r"frame +60/", patience=60)
    screen.wait(r"paused *$", patience=60)
    do(screen, "run.turn alpha=0")
    until(screen, 90)
    do(screen, "screen compare")
    screen.wait("particles by")
    do(screen, "compare.frame 90")
    do(screen, "compare.mode")
    screen.wait(r"frame 90 .*frame 90", patience=60)


@shot(120, 36)
def sheet(screen):
    until(screen, 60)
    do(screen, "run.mode")


# A library of sixteen runs for the screens of past runs: a sweep over two parameters.
SWEEP = """return require("sunder").sweep {{
  title = "How it tears", scene = "{scenes}/solid/tube_pull.lua", frames = 36, set = {{ particles = 1500, pull = 0.4 }},
  over = {{ break_stretch = {{ 0.05, 0.1, 0.2, 0.3 }}, eta = {{ 0.05, 0.2, 0.45, 0.8 }} }},
}}
"""


@shot(140, 32)
def runs(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    do(screen, "runs.columns eta break_stretch broken_fraction damage_mean wall_s tags variant")
    do(screen, "runs.sort -broken_fraction")
    screen.keys("Space", "Space", "Space")


@shot(120, 36)
def runs_plot(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Space", "Down", "Down", "Down", "Space", "Down", "Down", "Down", "Space")
    do(screen, "runs.plot broken_fraction")


@shot(120, 32)
def runs_diff(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Space", "Space", "Space", "d")


@shot(100, 30)
def runs_frames(screen):
    do(screen, "screen runs")
    screen.wait("16 of 16 runs")
    screen.keys("Enter")
    screen.wait("frame 0 of 36")
    do(screen, "runs.frame 30")


@shot(100, 30)
def sweep(screen):
    do(screen, "screen sweep")
    do(screen, "sweep.choose tearing.lua")
    screen.wait("16 done")
    screen.keys("Right", "Down")


LIBRARY = ("runs", "runs_plot", "runs_diff", "runs_frames", "sweep")
ARGUMENTS = {"sheet": run("sheet/paper_towel.lua"), **{name: "" for name in LIBRARY}}


def fill_library(sunder, home):
    """Makes the sixteen runs in the ledger of `home`, once for all pictures."""
    os.makedirs(f"{home}/sweeps", exist_ok=True)
    with open(f"{home}/sweeps/tearing.lua", "w", encoding="utf-8") as file:
        file.write(SWEEP.format(scenes=os.path.abspath(SCENES)))
    subprocess.run([sunder, "sweep", "sweeps/tearing.lua", "--threads", "1", "--quiet", "--db", f"{home}/ledger.db"], cwd=home, check=True,
                   env=dict(os.environ, XDG_DATA_HOME=home))


def take(sunder, name, out, library):
    function, width, height = SHOTS[name]
    test_tui.DEMO = sunder
    with tempfile.TemporaryDirectory() as home:
        if name in LIBRARY:
            home = library
        variables = f"export XDG_DATA_HOME={home} XDG_CONFIG_HOME={home};{f' cd {home};' if name in LIBRARY else ''}"
        with Screen(f"{ARGUMENTS.get(name, TUBE)} --db {home}/ledger.db", width=width, height=height, variables=variables) as screen:
            function(screen)
            screen.wait(r"\S")
            time.sleep(5)  # notices go
            path = os.path.join(out, f"{name}.png")
            terminal_picture.save(screen.text(True), width, height, path)
            print(path, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sunder")
    parser.add_argument("--out", default="docs/pictures")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    failed = 0
    names = options.names or list(SHOTS)
    with tempfile.TemporaryDirectory() as library:
        if set(names) & set(LIBRARY):
            fill_library(os.path.abspath(options.sunder), library)
        for name in names:
            try:
                take(os.path.abspath(options.sunder), name, options.out, library)
            except (Failure, KeyError) as error:
                failed += 1
                print(f"{name}: {error}", file=sys.stderr)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
