"""The Accuracy screen."""
import re

import bench
from bench import check, covers

SMALL = "--set particles=600 --set break_stretch=0.02 --set pull=0.6"


def ask(s, key, value, pattern):
    s.keys(key)
    s.wait(r"^:accuracy\.")
    s.type(value)
    s.keys("Enter")
    s.wait(pattern, patience=60)


def studied(s):
    """Runs that a study has made, the oldest first."""
    return [row[0] for row in s.sql("SELECT id FROM runs WHERE status = 'done' AND run IN (SELECT run FROM tags WHERE tag LIKE 'accuracy:%') ORDER BY run")]


@covers("accuracy.choose", "accuracy.axis", "accuracy.levels", "accuracy.frames", "accuracy.budget", "accuracy.run", "accuracy.error", "accuracy.plot", "accuracy.up",
        "accuracy.down", "accuracy.adopt", "accuracy.back", start=None, width=80, height=24)
def a_study_is_made(s):
    s.wait(r"\[Scenes\]")
    s.do("scenes.choose tube_pull")
    for word in SMALL.split("--set ")[1:]:
        s.do(f"scenes.set {word.strip()}")
    s.do("screen accuracy")
    s.wait(r"Enter +takes the scene that is chosen on Scenes")
    s.keys("Enter")
    s.wait(r"\[x\] resolution: particles", patience=60)
    s.wait(r"3 levels: \d+ runs to make")
    ask(s, "l", "2", r"2 levels")
    ask(s, "f", "2", r"2 levels, 2 frames")
    ask(s, "b", "500", r"2 frames, at most 500 s")
    s.wait(r"\[x\] resolution: particles", patience=60)
    s.keys("Space")
    s.wait(r"\[ \] resolution")
    s.keys("Space")
    s.wait(r"\[x\] resolution")
    s.do("accuracy.axis colour")
    s.wait(r"expected an axis of this scene")
    for axis in ("step", "kernel", "laplacian", "damage.form"):
        s.do(f"accuracy.axis {axis}")
    s.wait(r"3 runs to make")  # the scene's own, twice the particles, double precision
    s.keys("r")
    s.wait(r"The study has ended", patience=120)
    ids = studied(s)
    check(len(ids) == 3, f"a run each of what is marked: {ids}")
    s.wait(r"reference")
    check(re.search(r"\d(\.\d+)?x +[\d.e-]+ %", s.text()), f"times and errors:\n{s.text()}")
    s.wait(r"\[ \] step")
    s.do("accuracy.error damage")
    s.wait(r"steps s +time +damage")
    s.keys("e")
    s.wait(r"steps s +time +(?!damage)\w+")
    s.do("accuracy.error error")
    s.keys("p")
    s.wait(r"against seconds of steps")
    s.keys("p")
    s.wait(r"steps s +time +error")
    s.keys("Up", "Up", "Up")
    s.wait(r"^ particles 600  ")
    s.keys("Down")
    s.wait(r"^ particles 1200  ")
    s.keys("Up", "Enter")
    s.wait(r"frame 0 of 2", patience=60)
    s.do("screen accuracy")
    s.keys("Down", "a")
    s.until("a run with what the level sets", lambda: s.sql("SELECT count(*) FROM run_parameters WHERE name = 'particles' AND number = 1200") == [[2]])
    s.do("screen accuracy")
    s.keys("BSpace")
    s.wait(r"Enter +takes the scene that is chosen on Scenes")


@covers("accuracy.stop", start=None, width=200, height=60)
def a_study_is_stopped(s):
    s.wait(r"\[Scenes\]")
    s.do("screen accuracy")
    s.do(f"accuracy.choose {bench.SCENES}/solid/nowhere.lua")
    s.wait(r"nowhere\.lua")
    s.do(f"accuracy.choose {bench.SCENES}/solid/tube_pull.lua {SMALL} --frames 2000 --threads 1")
    s.wait(r"\[x\] resolution", patience=60)
    s.wait(r"against seconds of steps")
    s.keys("r")
    s.until("a run", lambda: s.sql("SELECT count(*) FROM runs WHERE status = 'running'") == [[1]])
    s.wait(r"started")
    s.keys("S")
    s.wait(r"The study has ended: stopped", patience=60)
    check(s.sql("SELECT count(*) FROM runs WHERE status = 'running'") == [[0]], "its run ended with it")


@covers("accuracy.of-run", width=100, height=40)
def the_scene_of_the_run_in_view(s):
    s.paused()
    s.do("screen accuracy")
    s.keys("c")
    s.wait(r"\[x\] resolution: particles", patience=60)
    s.wait(r"Tube pull: 1\d\d\d particles, 48 frames")
