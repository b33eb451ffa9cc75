"""The Compare screen, over a run and its branch."""
import re

from bench import check, covers

SMALL = "solid/tube_pull.lua --set particles=1200 --set duration=2 --paused"


def branched(s):
    """A run up to frame 30 and its branch from frame 20, with another break stretch, up to frame 33; side by side."""
    s.paused().do("run.run-to 30")
    s.wait(r"frame +30/")
    s.wait(r"paused *$")
    s.do("run.branch 20")
    s.wait(r"frame +20/")
    s.wait(r"paused *$")
    s.do("run.turn break_stretch=0.01")
    s.wait(r"break_stretch = 0\.01")
    s.do("run.run-to 33")
    s.wait(r"frame +33/")
    s.do("screen compare")
    s.shows(r"^ A \d{8}-\S+", r"B \d{8}-\S+", r"frame 30 .*frame 30")
    return s


@covers("compare.next", "compare.previous", "compare.on", "compare.back", "compare.first", "compare.last", "compare.frame", start=SMALL)
def frames(s):
    branched(s).shows(r"@20 \S*break_stretch = 0\.01", r"particles by damage: A, B")
    for key, frame in (("Left", 29), ("Right", 30), ("PPage", 20), ("NPage", 30), ("Home", 0), ("End", 30)):
        s.keys(key)
        s.wait(rf"frame {frame} .*frame {frame}\b")
    s.keys("Home")
    s.wait(r" 0\.00 % differ")  # until the branch they are one
    s.keys("r")
    s.type("30")
    s.keys("Enter")
    s.wait(r"frame 30 .*frame 30")
    check(float(s.wait(r"(\d+\.\d+) % differ").group(1)) > 0, "other knobs, the same histogram")
    s.do("compare.frame 2.5")
    s.wait(r"the number of a frame")


@covers("compare.left", "compare.right", "compare.swap", "compare.branch", start=SMALL)
def runs(s):
    branched(s)
    parent, branch = (row[0] for row in s.sql("SELECT id FROM runs ORDER BY run"))
    s.wait(rf"^ A {parent} .*B {branch}")
    s.keys("w")
    s.wait(rf"^ A {branch} .*B {parent}")
    s.keys("b")
    s.wait(rf"^ A {parent} .*B {branch}")
    s.keys("A")
    s.type(branch)
    s.keys("Enter")
    s.shows(rf"^ A {branch} .*B {branch}", r"no parameter differs", r" 0\.00 % differ")
    s.keys("B")
    s.type(parent)
    s.keys("Enter")
    s.wait(rf"^ A {branch} .*B {parent}")
    s.do("compare.left nosuchrun")
    s.wait(r"nosuchrun")


@covers("compare.play", "compare.colour", "compare.scale", "compare.histogram", "compare.mode", start=SMALL)
def looks(s):
    branched(s).keys("Home")
    s.wait(r"frame 0 .*frame 0")
    s.keys("Space")
    s.wait(r"frame 30 .*frame 30")
    s.do("compare.scale 0 0.25")
    s.wait(r"damage 0 █+ 0\.25 set.*damage 0 █+ 0\.25")
    s.keys("v")
    name = s.wait(r"Coloured by (\S+)\.").group(1)
    s.wait(rf"particles by {name}: A, B")
    s.keys("n")
    s.wait(r"log +\d")
    s.keys("m")
    s.shows(r"Particles as blocks", r"[▀▄]{4}")


@covers("compare.turn-left", "compare.turn-right", "compare.tilt-up", "compare.tilt-down", "compare.zoom-in", "compare.zoom-out", "compare.look",
        "compare.reset", "compare.cut", "compare.cut-in", "compare.cut-out", "compare.cut-flip", start=SMALL)
def camera(s):
    """Both pictures have one camera."""
    branched(s)
    for keys, shown in (("l", r"yaw +\+3[78]"), ("h", r"yaw +\+30"), ("k", r"pitch +\+29"), ("j", r"pitch +\+22"), ("+", r"zoom +1\.25"),
                        ("-", r"zoom +1\.00"), ("i", r"yaw +\+0"), ("0", r"yaw +\+30"), ("x", r"cut x 50%"), ("(", r"cut x 46%"), (")", r"cut x 50%"),
                        ("X", r"cut -x 50%")):
        s.keys(keys)
        s.wait(rf"{shown}.*│.*{shown}")
    check(len(re.findall(r"cut -x", s.text())) == 2, "the pictures are not cut alike")
