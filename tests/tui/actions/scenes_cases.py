"""The Scenes screen."""
import glob
import os

import bench
from bench import check, covers


def listed(s):
    return s.wait(r"\[Scenes\]") and s.wait(r"solid/tube_pull")


@covers("scenes.up", "scenes.down", "scenes.page-up", "scenes.page-down", start=None)
def moves(s):
    listed(s)
    s.shows(r"│ ?Tube pull", r"contains ─", r"effects ─")
    s.shows(r"pull +0\.1 +length/time, speed of e.*…$")  # what does not fit says so
    s.keys("Up")
    s.wait(r"solid/tube_compress\.lua")
    s.keys("Down")
    s.wait(r"│ ?.*solid/tube_pull\.lua")
    s.keys("PPage")
    s.wait(r"solid/tube_pull\.lua", absent=True)
    s.keys(*["NPage"] * 10)
    s.wait(os.path.relpath(max(glob.glob(f"{bench.SCENES}/*/*.lua")), bench.SCENES).replace(".", r"\."))


@covers("scenes.filter-type", "scenes.filter", start=None)
def filters(s):
    listed(s)
    s.keys("/")
    s.type("seaw")
    s.shows(r"^ ?/seaw", r"1 of \d+", r"sheet/seaweed\.lua")
    s.keys("Enter", "?")
    s.wait(r"^keys")
    s.keys("?")
    s.do("scenes.filter bone")
    s.shows(r"solid/bone\.lua")
    s.keys("/", "Escape")
    s.shows(r"solid/bone ", r"solid/fish ")
    s.do("scenes.filter nosuchscene")
    s.wait(r"No scene has that")


@covers("scenes.choose", "scenes.reload", start=None)
def choose(s):
    listed(s)
    s.do("scenes.choose foil")
    s.wait(r"sheet/foil\.lua")
    s.do("scenes.choose foill")
    s.wait(r"did\s+you\s+mean")
    with open(f"{s.folder}/mine.lua", "w", encoding="utf-8") as file:
        file.write('-- My own.\nlocal s = require "sunder"\nreturn s.scene { title = "Mine" }\n')
    s.keys("R")
    s.wait(r"\d+ scenes\.")
    s.do("scenes.choose mine")
    s.shows(r"My own", r"mine\.lua:3")  # what is wrong with it, with its line


@covers("scenes.settings", "scenes.list", "scenes.enter", start=None, width=100, height=40)
def settings(s):
    listed(s)
    s.wait(r"variant +full")
    s.keys("Right", "Down", "Down", "Down", "Down", "Down", "Down")
    s.wait(r"Enter changes")
    s.keys("Enter")  # the variant is the last parameter: the next one
    s.wait(r"variant +isotropic")
    s.keys("Up", "Enter")
    s.wait(r"^:scenes\.set pull=0\.1")
    s.keys("BSpace")
    s.type("25")
    s.keys("Enter")
    s.wait(r"pull +0\.25")
    s.keys("Left")
    s.wait(r"Enter changes", absent=True)


@covers("scenes.set", "scenes.variant", "scenes.recipe", "scenes.precision", "scenes.clear", start=None, width=100, height=40)
def choices(s):
    listed(s)
    s.wait(r"variant +full")
    s.keys("v")
    s.wait(r"variant +isotropic")
    s.keys("s")
    s.wait(r"^:scenes\.set")
    s.type("ang")
    s.keys("Tab")
    s.wait(r"^:scenes\.set angle=")
    s.type("20")
    s.keys("Enter")
    s.wait(r"angle +20")
    s.keys("r")
    s.type("rub")
    s.keys("Tab", "Enter")
    s.wait(r"recipe +rubber_film")
    s.do("scenes.recipe jello")
    s.wait(r"recipe +jello")
    s.keys("d")
    s.wait(r"double precision")
    s.do("scenes.set tube.damage.etaa=1")
    s.wait(r"etaa")
    s.keys("x")
    s.shows(r"variant +full", r"recipe +the scene's own")


@covers("scenes.plan", start=None, width=100, height=40)
def plan(s):
    listed(s)
    s.do("scenes.set particles=2000")
    s.keys("p")
    s.shows(r"about .* for \d+ frames", r"steps of \d", r"bytes a particle")


@covers("scenes.start", start=None)
def starts(s):
    listed(s)
    s.do("scenes.set particles=900")
    s.do("scenes.set duration=0.1")
    s.keys("S")
    s.shows(r"\[Run\]", r"done *$")
    check(s.sql("SELECT particles > 500 FROM runs") == [[1]], "the run is not in the ledger")
    log = s.commands()
    check("start " in log and "--set particles=900" in log, f"the log has no start: {log}")
    s.keys("F2", "Enter")
    s.shows(r"\[Run\]")
