"""The Run screen: each action by its key (or the palette where it has none). What runs mean to the ledger is in test_run_screen.py."""
import os
import re
import time

from bench import check, covers

TORN = "solid/tube_pull.lua --set particles=1200 --set duration=2 --set break_stretch=0.02"


@covers("run.pause", "run.step")
def pause(s):
    s.paused()
    frame = s.frame()
    time.sleep(0.4)
    check(s.frame() == frame, "frames go on while paused")
    s.keys("s")
    s.wait(rf"frame +{frame + 1}/")
    time.sleep(0.3)
    check(s.frame() == frame + 1, "one key, more than one frame")
    s.keys("Space")
    s.wait(r"(running|done) *$")
    s.wait(rf"frame +(?!{frame + 1}/)\d+/")


@covers("run.run-to", "run.stop")
def run_to(s):
    s.paused()
    frame = s.frame() + 3
    s.keys("r")
    s.type(str(frame))
    s.keys("Enter")
    s.wait(rf"frame +{frame}/")
    s.wait(r"paused *$")
    s.keys("S")
    s.wait(r"stopped *$")
    check(s.sql("SELECT status, frames FROM runs") == [["interrupted", frame]], f"in the ledger: {s.sql('SELECT status, frames FROM runs')}")


def knob(s, name):
    """The value of a knob on the panel."""
    return float(s.wait(rf"[│ ▸>]{name} +(-?[\d.e+-]+)").group(1))


@covers("run.knob", "run.turn", "run.knob-more", "run.knob-less", "run.knob-more-fine", "run.knob-less-fine", "run.undo", "run.redo", "run.knob-reset",
        "run.knobs-reset", width=120, height=40)
def knobs(s):
    s.paused().keys("/")
    s.type("eta")
    s.keys("Enter")
    s.wait(r"[▸>]eta")
    s.do("run.turn eta=0.2")
    s.until("0.2", lambda: knob(s, "eta") == 0.2)
    for keys, wanted in ((("Right",), 0.25), (("Left",), 0.2), ((".",), 0.204), ((",",), 0.2)):
        s.keys(*keys)
        s.until(f"{keys}: {wanted}", lambda: abs(knob(s, "eta") / wanted - 1) < 3e-3)
    s.do("run.turn eta=0.5")
    s.until("0.5", lambda: knob(s, "eta") == 0.5)
    s.keys("u")
    s.until("undo", lambda: abs(knob(s, "eta") - 0.2) < 1e-3)
    s.keys("U")
    s.until("redo", lambda: knob(s, "eta") == 0.5)
    s.keys("DC")
    s.wait(r"eta = \S+ from the next frame on")
    s.do("run.turn alpha=-0.25")
    s.until("alpha", lambda: knob(s, "alpha") == -0.25)
    s.keys("Z")
    s.wait(r"as the recipe has")
    s.keys("s")
    s.until("turns in the ledger", lambda: s.sql("SELECT count(*) FROM knob_turns")[0][0] >= 5)


@covers("run.knob-up", "run.knob-down", "run.knob-page-up", "run.knob-page-down", "run.knob-type", "run.knob-other", width=120, height=40)
def knob_cursor(s):
    def at():
        return s.wait(r"[▸>](\w+)").group(1)
    s.paused()
    for there, back in (("Down", "Up"), ("NPage", "PPage")):
        first = at()
        s.keys(there)
        s.until(there, lambda: at() != first)
        s.keys(back)
        s.until(back, lambda: at() == first)
    s.do("run.knob acceleration")
    s.wait(r"arrows: x")
    s.keys("o")
    s.wait(r"arrows: y")
    s.do("run.knob eta")
    s.wait(r"[▸>]eta")
    s.keys("Enter")
    s.wait(r"^:run\.turn \S*eta=")
    s.keys("Escape")


@covers("run.save-recipe")
def save_recipe(s):
    s.paused().keys("w")
    s.wait(r"^:run\.save-recipe")
    s.keys("Enter")
    s.wait(r"is in tuned\.lua")
    check(os.path.getsize(os.path.join(s.folder, "tuned.lua")) > 100, "an empty recipe")


@covers("run.earlier", "run.later", "run.choose", "run.branch")
def branch(s):
    s.paused().do("run.run-to 6")
    s.wait(r"frame +6/")
    s.wait(r"paused *$")
    s.keys("[", "[")
    first = int(s.wait(r"Frame (\d+): b goes on").group(1))
    s.keys("]")
    s.until("a later one", lambda: int(s.wait(r"Frame (\d+): b goes on").group(1)) > first)
    s.do("run.choose 3")
    s.wait(r"Frame 3: b goes on")
    s.keys("b")
    s.wait(r"frame +3/")
    s.until("the branch in the ledger", lambda: s.sql("SELECT parent_frame FROM runs WHERE parent IS NOT NULL") == [[3]])


@covers("run.restart")
def restart(s):
    s.paused().do("run.turn density=3")
    s.wait(r"restart")
    s.keys("R")
    s.wait(r"Stop this run and start again")
    s.keys("y")
    s.until("a second run", lambda: len(s.sql("SELECT id FROM runs")) == 2)


@covers("run.panel", "run.whole", "run.histogram", start=TORN)
def panels(s):
    s.paused()
    s.wait(r"kinetic ")
    s.keys("p")
    s.wait(r"damage over time")
    s.changes("n")
    s.changes("n")
    s.keys("p")
    s.wait(r"[▸>]\w+")
    s.changes("z")
    s.changes("z")
    s.do("run.panel numbers")
    s.wait(r"kinetic ")


@covers("run.colour", "run.scale", "run.mode", "run.colours", start=TORN)
def colours(s):
    s.paused().keys("v")
    s.wait(r"Coloured by (?!damage)\S+")
    s.do("run.colour damage")
    s.do("run.scale 0 0.5")
    s.wait(r"0\.5")
    s.do("run.scale auto")
    for name, glyphs in (("blocks", r"[▀▄]{3}"), ("ascii", r"[-.:=+*#%@]{4}"), ("braille", r"[\u2801-\u28ff]{4}")):
        s.keys("m")
        s.wait(f"Particles as {name}")
        s.wait(glyphs)
    for name in ("lagoon", "civic", "ink", "ember"):
        s.keys("c")
        s.wait(f"Colours: {name}")


def degrees(s, name):
    return float(s.wait(rf"{name} +([-+]\d+)").group(1))


@covers("run.turn-left", "run.turn-right", "run.tilt-up", "run.tilt-down", "run.zoom-in", "run.zoom-out", "run.reset", "run.spin", "run.look")
def camera(s):
    s.paused()
    for key, name, sign in (("h", "yaw", -1), ("l", "yaw", 1), ("k", "pitch", 1), ("j", "pitch", -1)):
        before = degrees(s, name)
        s.keys(key)
        s.until(key, lambda: 6 <= sign * (degrees(s, name) - before) <= 9)
    view = s.wait(r"yaw .* zoom +\S+").group(0)
    s.keys("+")
    s.wait(r"zoom +1\.25")
    s.keys("-", "-")
    s.wait(r"zoom +0\.80")
    s.keys("0")
    s.wait(re.escape(view))
    s.keys("a")
    s.until("spinning", lambda: abs(degrees(s, "yaw") - 30) > 8)
    s.keys("a")
    s.wait("stands still")
    s.keys("i")
    s.wait(r"Seen from the")


@covers("run.pan-left", "run.pan-right", "run.pan-up", "run.pan-down", "run.cut", "run.cut-in", "run.cut-out", "run.cut-flip")
def pan_and_cut(s):
    s.paused()
    for key in "HLKJ":
        s.changes(key)
    s.keys("x")
    share = int(s.wait(r"cut x +(\d+) %").group(1))
    s.keys("(")
    s.until("in", lambda: int(s.wait(r"cut x +(\d+) %").group(1)) < share)
    s.keys(")")
    s.until("out", lambda: int(s.wait(r"cut x +(\d+) %").group(1)) == share)
    s.keys("X")
    s.wait(r"cut -x")
    s.do("run.cut off")
    s.wait(r"cut ", absent=True)
