#!/usr/bin/python3
"""Takes the pictures of the workbench in docs/pictures: opens it in tmux, does what a user would, draws what tmux captured.

Usage: tests/tui/screenshots.py SUNDER [--out docs/pictures] [NAME ...]     from the root of the repository
Needs tmux, python3-pil and fonts-dejavu-core. Each NAME is a function here; without names all of them are taken.
"""
import argparse
import os
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


ARGUMENTS = {"sheet": run("sheet/paper_towel.lua")}


def take(sunder, name, out):
    function, width, height = SHOTS[name]
    test_tui.DEMO = sunder
    with tempfile.TemporaryDirectory() as home:
        variables = f"export XDG_DATA_HOME={home} XDG_CONFIG_HOME={home};"
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
    for name in options.names or SHOTS:
        try:
            take(os.path.abspath(options.sunder), name, options.out)
        except (Failure, KeyError) as error:
            failed += 1
            print(f"{name}: {error}", file=sys.stderr)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
