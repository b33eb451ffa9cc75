#!/usr/bin/env python3
"""A scene of solids and sheets: each does in it what it does alone, and every command knows both.

Usage: test_both_kinds.py SUNDER [NAME...]   Runs work in a scratch folder and with a ledger of their own.
"""
import json, os

import harness
from frame_reader import FrameReader
from harness import SOURCE, SUNDER, check, run_tests

SCENE = os.path.join(SOURCE, "scenes/both/bar_and_film.lua")


class Box(harness.Box):
    def sunder(self, *arguments):
        """What it prints."""
        code, out, err = self.call(*arguments)
        check(code == 0, f"sunder {' '.join(arguments[:2])}: exit {code}: {err[-300:]}")
        return out

    def run(self, label, *arguments, scene=SCENE):
        out = self.path(label)
        text = self.sunder("run", scene, "--precision", "f64", "--json", "--quiet", "--out", out, "--set", "particles=2000", *arguments)
        return out, json.loads(text or "{}")


def test_each_does_what_it_does_alone():
    reader = FrameReader(SUNDER)
    with Box() as box:
        both, summary = box.run("both", "--frames", "4")
        solid, _ = box.run("solid", "--frames", "4", "--set", "kind=solid")
        sheet, _ = box.run("sheet", "--frames", "4", "--set", "kind=sheet")
        for alone, kind in ((solid, "solid"), (sheet, "sheet")):
            for field in ("position", "velocity"):
                there, here = reader.read(alone, 4, f"/{kind}/{field}"), reader.read(both, 4, f"/{kind}/{field}")
                check(len(here) > 1000 and here == there, f"{kind}: {field} beside the other kind is that alone, to the bit")
        moved = max(abs(a - b) for a, b in zip(reader.read(both, 0, "/sheet/position"), reader.read(both, 4, "/sheet/position")))
        check(moved > 0.01, f"the film is drawn apart: {moved}")
        count = sum(len(reader.read(both, 0, f"/{kind}/id")) for kind in ("solid", "sheet"))
        check(summary["particles"] == count, f"particles of both are counted: {summary['particles']}, {count}")
        check(os.path.exists(os.path.join(both, "frames", "sheet", "000004.hdf")), "the sheet has a view of its own beside the frame")


def test_a_resumed_run_has_the_same_bits():
    reader = FrameReader(SUNDER)
    with Box() as box:
        whole, _ = box.run("whole", "--frames", "6")
        part, _ = box.run("part", "--frames", "3", "--checkpoint-every", "1")
        box.sunder("run", "--resume", "last", "--frames", "6", "--json", "--quiet")
        for path in ("/solid/position", "/sheet/position", "/solid/velocity", "/sheet/bond_broken"):
            check(reader.read(whole, 6, path) == reader.read(part, 6, path), f"{path} after a resumed run")
        threads, _ = box.run("threads", "--frames", "6", "--threads", "3")
        for path in ("/solid/position", "/sheet/position"):
            check(reader.read(whole, 6, path) == reader.read(threads, 6, path), f"{path} on three threads")


def test_the_film_tears_and_the_bar_holds():
    with Box() as box:
        out, _ = box.run("tear")
        reader = FrameReader(SUNDER)
        broken = sum(reader.read(out, 36, "/sheet/bond_broken")) - sum(reader.read(out, 0, "/sheet/bond_broken"))
        check(broken > 60, f"the film tears across: {broken} bonds")
        picture = box.path("picture.png")
        box.sunder("render", "last", "--out", picture)
        check(os.path.getsize(picture) > 2000, "a picture of both")
        box.sunder("render", "last", "--out", picture, "--colour", "sheet/broken")
        listed = box.sunder("runs", "list")
        check("Bar and film" in listed, "the ledger lists the run")


def test_a_film_catches_a_ball_or_tears():
    scene = os.path.join(SOURCE, "scenes/both/ball_on_film.lua")
    with Box() as box:
        check("pass through" not in box.sunder("check", scene), "no note where they touch")
        reader, height, broken = FrameReader(SUNDER), {}, {}
        for film in ("strong", "weak", "none"):
            out, _ = box.run(film, "--set", f"film={film}", "--set", "spacing=0.04", "--set", "duration=1", scene=scene)
            z = reader.read(out, 24, "/solid/position")[2::3]
            height[film], broken[film] = sum(z) / len(z), sum(reader.read(out, 24, "/sheet/bond_broken"))
        print("  the ball is at", height, "bonds broken", broken)
        check(height["strong"] > -0.3 and broken["strong"] == 0, "a strong film catches the ball")
        check(height["weak"] < -0.6 and broken["weak"] > 10, "a weak one tears and lets it through")
        check(abs(height["none"] - (0.3 - 0.5 * 4)) < 0.02 and broken["none"] == 0, "without contact it falls freely")


def test_the_commands_say_that_there_are_both():
    with Box() as box:
        note = "pass through one another"
        check(note in box.sunder("check", SCENE), "check notes that they do not touch")
        check(note in json.loads(box.sunder("check", SCENE, "--json"))["notes"][0], "and says so in JSON")
        check(json.loads(box.sunder("check", SCENE, "--json", "--set", "kind=solid"))["notes"] == [], "no note for solids alone")
        plan = json.loads(box.sunder("explain", SCENE, "--json"))
        check({"elastic", "linear", "fracture"} <= set(plan["effects_on"]), f"explain names effects of both: {plan['effects_on']}")
        check({"elastic", "linear"} <= set(plan["step_limits"]), "and limits of both")
        check("p2g" in plan["stages"] and "bonds" in plan["stages"], f"and stages of both: {plan['stages']}")
        check(note in box.sunder("explain", SCENE), "and that they do not touch")


run_tests(globals())
