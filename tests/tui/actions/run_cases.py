"""The Run screen: knobs, frames, branches, what is seen."""
import os
import re
import subprocess
import time

import bench
from bench import check, covers


def value(s, key):
    """What the list of knobs shows for a key."""
    return float(s.wait(rf"[│▸ ]{key} +(-?\d[\d.e+-]*)").group(1))


def reaches(s, key, wanted, what):
    s.until(f"{key} {wanted} by {what}", lambda: abs(value(s, key) / wanted - 1) < 2e-3)


def dots(s):
    return len(re.findall(r"[\u2801-\u28ff]", s.text()))


# ---- knobs -----------------------------------------------------------------------------------------------------------

@covers("run.panel", "run.whole")
def panels(s):
    s.paused()
    s.shows(r"numbers damage knobs time events", r"kinetic ")
    for pattern in (r"damage over time", r"▸", r"time of steps", r"events ─", r"kinetic "):
        s.keys("p")
        s.wait(pattern)
    s.do("run.panel time")
    s.shows(r"dt +\d\.\d+e-\d\d +[▁-█]", r"frame +\d+\.\d+ m?s +[▁-█]", r"p2g +\d")
    s.do("run.panel knobz")
    s.wait(r"did\s+you\s+mean\s+'?knobs")
    s.do("run.panel knobs")
    s.keys("z")
    s.wait(r"^ [ ▸]sigma_c +\S+ = +break_stretch +0\.2$")
    s.keys("z")
    s.wait(r"(?s)│ [ ▸]sigma_c +\d\S+ [─┼●]+ *\n[^\n]*│  = break_stretch +0\.2 ")


@covers("run.knob-up", "run.knob-down", "run.knob-page-up", "run.knob-page-down", "run.knob", "run.knob-other")
def cursor(s):
    s.paused().keys("Down")  # the first press shows the knobs
    s.shows(r"▸sigma_c", r"damage\.sigma_c ─* ?mass/", r"follows", r"│ +3\.196e\+04 *$")  # the first that is live
    s.keys("Up")
    s.shows(r"▸density", r"particles got their masses from it")
    s.keys("Down")
    s.wait(r"▸sigma_c")
    s.keys("o")
    s.shows(r"=▸break_stretch", r"live: acts at the next frame")
    s.keys("Up")
    s.wait(r"▸density")
    s.keys("NPage")
    s.wait(r"▸density", absent=True)
    s.wait(r"▸\w")
    s.keys("PPage")
    s.wait(r"▸density")
    s.keys("/")
    s.type("accel")
    s.keys("Tab", "Enter")
    s.shows(r"▸acceleration", r"arrows: x")
    s.keys("o")
    s.wait(r"arrows: y")
    s.do("run.knob alpha")
    s.keys("o")
    s.wait(r"no twin")


@covers("run.knob-more", "run.knob-less", "run.knob-more-fine", "run.knob-less-fine")
def arrows(s):
    s.paused().do("run.knob eta")
    before = value(s, "eta")
    for key, factor in (("Right", 1.25), ("Left", 1), (".", 1.02), (",", 1), (">", 1.02), ("<", 1), ("Right", 1.25)):
        s.keys(key)
        reaches(s, "eta", before * factor, key)
    frame = s.frame()
    s.keys("s")
    s.wait(rf"frame +{frame + 1}/|▲")
    row = s.until("the turn in the ledger", lambda: s.sql("SELECT path, value, frame FROM knob_turns ORDER BY turn DESC LIMIT 1"))[0]
    check(row[0].endswith("damage.eta") and abs(float(row[1]) / (before * 1.25) - 1) < 1e-3 and row[2] == frame, f"in the ledger: {row}")
    check(re.search(rf"^{frame} run\.knob-more \S*damage\.eta=", s.commands(), re.M), f"the log: {s.commands()}")


@covers("run.turn", "run.knob-type")
def types(s):
    s.paused().do("run.knob eta")
    s.wait(r"▸eta")
    s.keys("Enter")
    s.wait(r"^:run\.turn \S*damage\.eta=0\.45")
    s.keys("BSpace", "BSpace")
    s.type("75")
    s.keys("Enter")
    s.wait(r"eta = 0\.75 from the next frame on")
    reaches(s, "eta", 0.75, "typing")
    s.do("run.turn etaa=1")
    s.wait(r"did\s+you\s+mean")
    s.do("run.turn eta=-1")
    s.wait(r"expected")
    s.do("run.turn eta")
    s.wait(r"KNOB=VALUE")
    reaches(s, "eta", 0.75, "wrong values")


@covers("run.undo", "run.redo")
def undo(s):
    """Undoing the turn of a twin gives back what was said, not a number computed from the other."""
    s.paused().do("run.turn break_stretch=0.3")
    s.wait(r"break_stretch = 0\.3 from the next frame on")
    s.do("run.turn sigma_c=12500")
    s.wait(r"sigma_c = 1\.25e\+04 from the next frame on")
    s.keys("u")
    s.wait(r"break_stretch = 0\.3\d* again")
    s.wait(r"▸break_stretch +0\.3\b")
    s.keys("U")
    s.wait(r"sigma_c = 12500 again")
    s.keys("u", "u")
    s.wait(r"break_stretch = 0\.2\d* again")
    s.keys("u")
    s.wait(r"No knob has been turned")


@covers("run.knob-reset", "run.knobs-reset")
def resets(s):
    s.paused().do("run.turn eta=0.5")
    start = float(s.wait(r"start ([\d.e+-]+)").group(1))
    s.keys("DC")
    s.wait(rf"eta = {start:g} from the next frame on")
    s.do("run.turn eta=0.5")
    s.do("run.turn alpha=-0.5")
    s.wait(r"alpha = -0\.5 from")
    s.keys("Z")
    s.wait(r"2 knobs are as the recipe has them")
    reaches(s, "eta", start, "Z")
    s.keys("Z")
    s.wait(r"All knobs are as the recipe has them")


@covers("run.restart")
def restart(s):
    """What is not live waits for a restart, which takes the live ones along."""
    s.paused().do("run.turn eta=0.375")
    s.do("run.turn density=300")
    s.shows(r"density = 300 at a restart", r"1 for a restart")
    s.keys("R")
    s.wait(r"Stop this run and start again")
    s.keys("y")
    s.until("a second run", lambda: len(s.sql("SELECT 1 FROM runs")) == 2)
    rows = dict(s.sql("SELECT p.name, p.number FROM run_parameters AS p JOIN runs USING (run) WHERE runs.run = 2"))
    found = {key.split(".")[-1]: number for key, number in rows.items()}
    check(found["density"] == 300 and found["eta"] == 0.375, f"parameters: {rows}")
    s.wait(r"1 for a restart", absent=True)


@covers("run.save-recipe")
def recipe(s):
    s.paused().do("run.turn eta=0.375")
    s.wait(r"eta = 0\.375")
    s.keys("w")
    s.wait(r"^:run\.save-recipe \S+ tuned\.lua")
    s.keys("Enter")
    s.wait(r"is in tuned\.lua")
    with open(os.path.join(s.folder, "tuned.lua"), encoding="utf-8") as file:
        check("0.375" in file.read(), "the recipe has not the tuned value")
    os.mkdir(os.path.join(s.folder, "recipes"))
    s.keys("w")
    s.wait(r"^:run\.save-recipe \S+ recipes/tuned\.lua")
    s.keys("Enter")
    s.wait(r"--recipe tuned takes it")
    os.remove(os.path.join(s.folder, "recipes", "tuned.lua"))
    with open(os.path.join(s.folder, "mine.lua"), "w", encoding="utf-8") as file:
        file.write('local s = require "sunder"\nreturn s.scene { title = "Mine", solids = { { shape = s.box { size = { 1, 1, 1 } }, '
                   'material = s.recipe("tuned"), particles = 100 } } }\n')
    done = subprocess.run([bench.SUNDER, "check", os.path.join(s.folder, "mine.lua")], capture_output=True, text=True, check=False,
                          env={**os.environ, "SUNDER_RECIPES": s.folder})
    check("tuned" not in done.stderr, f"the recipe does not load: {done.stderr}")
    s.do("run.save-recipe recipes/soft.flesh")
    s.wait(r"expected a file name that ends in \.lua")
    check(not os.listdir(os.path.join(s.folder, "recipes")), "a file that --recipe does not take")
    s.do("run.save-recipe recipes/soft")
    s.wait(r"is in recipes/soft\.lua; --recipe soft takes it")
    check(os.path.exists(os.path.join(s.folder, "recipes", "soft.lua")), "the recipe without an ending")
    check(re.search(r"run\.save-recipe \S+ recipes/soft\.lua$", s.commands(), re.M), f"the log: {s.commands()}")


# ---- frames ----------------------------------------------------------------------------------------------------------

@covers("run.pause", "run.step", "run.run-to")
def goes_on(s):
    s.paused()
    frame = s.frame()
    s.keys("s")
    s.wait(rf"frame +{frame + 1}/")
    s.keys("r")
    s.type(str(frame + 4))
    s.keys("Enter")
    s.wait(rf"frame +{frame + 4}/")
    s.wait(r"paused *$")
    time.sleep(0.3)
    check(s.frame() == frame + 4, "it did not stop there")
    s.do("run.run-to 1")
    s.wait(r"is past")
    s.do("run.run-to many")
    s.wait(r"expected")
    s.do("run.run-to 2.5")
    s.wait(r"a frame from 0 to")
    s.keys("Space")
    s.wait(rf"frame +(?!{frame + 4}/)\d+/")


@covers("run.earlier", "run.later", "run.choose", "run.branch")
def branches(s):
    s.paused().do("run.run-to 30")
    s.wait(r"frame +30/")
    s.wait(r"paused *$")
    parent = s.sql("SELECT id FROM runs")[0][0]
    s.keys("[")
    s.wait(r"Frame 30: b goes on")
    s.keys("[", "[")
    s.wait(r"Frame 28: b goes on")
    s.keys("]")
    s.wait(r"Frame 29: b goes on")
    s.do("run.choose 99999")
    s.wait(r"a frame from 0 to")
    s.do("run.choose 25")
    s.shows(r"Frame 25: b goes on", r"◆")
    s.keys("b")
    s.wait(r"frame +25/", "the branch")
    s.wait(r"paused *$")
    s.until("the branch in the ledger", lambda: s.sql("SELECT parent, parent_frame FROM runs WHERE parent IS NOT NULL") == [[parent, 25]])
    s.do("run.turn break_stretch=0.05")
    s.wait(r"break_stretch = 0\.05")
    s.keys("s")
    s.wait(r"▲")


@covers("run.stop")
def stops(s):
    s.paused().keys("S")
    s.wait(r"stopped *$")
    s.do("run.turn eta=1")
    s.wait(r"The run has ended")
    s.keys("[")
    s.wait(r"b goes on from here")


# ---- what is seen ----------------------------------------------------------------------------------------------------

@covers("run.turn-left", "run.turn-right", "run.tilt-up", "run.tilt-down", "run.zoom-in", "run.zoom-out", "run.reset", "run.look")
def camera(s):
    s.paused()
    view = s.wait(r"yaw .* zoom +\S+").group(0)
    for key, pattern in (("l", r"yaw +\+3[78]"), ("h", r"yaw +\+30"), ("k", r"pitch +\+29"), ("j", r"pitch +\+22"), ("+", r"zoom +1\.25"),
                         ("-", r"zoom +1\.00")):
        s.keys(key)
        s.wait(pattern)
    s.keys("i")
    s.shows(r"Seen from the front", r"yaw +\+0 +pitch +\+0")
    s.do("run.look top")
    s.wait(r"pitch \+90")
    s.do("run.look below")
    s.wait(r"corner, front, side or top")
    s.keys("0")
    s.wait(re.escape(view))


@covers("run.pan-left", "run.pan-right", "run.pan-up", "run.pan-down")
def pans(s):
    s.paused().wait(r"Pausing", absent=True)
    first = s.text()
    s.changes("L")
    s.changes("K")
    s.changes("H")
    s.keys("J")
    s.until("the picture as it was", lambda: s.text() == first)


@covers("run.spin")
def spins(s):
    s.paused().keys("a")
    first = int(s.wait(r"yaw +([-+]\d+)").group(1))
    s.until("a turn", lambda: int(s.wait(r"yaw +([-+]\d+)").group(1)) != first)
    s.keys("a")
    s.wait(r"stands still")


@covers("run.cut", "run.cut-in", "run.cut-out", "run.cut-flip")
def cuts(s):
    s.paused()
    whole = dots(s)
    s.keys("x")
    s.wait(r"cut x 50%")
    s.keys("(", "(")
    s.wait(r"cut x 42%")
    left = dots(s)
    check(left < 0.75 * whole, f"{left} of {whole} cells are left")
    s.keys(")")
    s.wait(r"cut x 46%")
    s.keys("X")
    s.wait(r"cut -x 46%")
    s.do("run.cut off")
    s.wait(r"cut -?[xyz]", absent=True)
    s.keys("(")
    s.wait(r"Nothing is cut")
    s.do("run.cut w")
    s.wait(r"x, y, z or off")


@covers("run.colour", "run.scale")
def colours_by(s):
    s.paused().wait(r"^ damage 0 █+ 1")
    s.do("run.scale 0 0.5")
    s.wait(r"^ damage 0 █+ 0\.5 set")
    s.do("run.scale 1 0")
    s.wait(r"two numbers")
    s.do("run.scale auto")
    s.wait(r"^ damage 0 █+ 1")
    s.keys("v")
    name = s.wait(r"Coloured by (\S+)\.").group(1)
    s.wait(rf"^ {name} \S")
    s.do("run.colour speed")
    s.wait(r"^ speed ")
    s.do("run.colour sped")
    s.wait(r"did\s+you\s+mean\s+'?speed")


@covers("run.mode", "run.colours", "run.histogram")
def looks(s):
    s.paused()
    s.wait(r"[\u2801-\u28ff]{4}")
    s.keys("m")
    s.shows(r"Particles as blocks", r"^[^│]*[▀▄]{4}[^│]*│")
    s.keys("m")
    s.shows(r"Particles as ascii", r"^[^│]*[-.:=+*#%@]{4}[^│]*│")
    s.keys("c")
    s.shows(r"Colours: lagoon", r"lagoon")
    s.keys("n")
    s.wait(r"particles by damage ─+ log")
