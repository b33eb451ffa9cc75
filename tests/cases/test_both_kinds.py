#!/usr/bin/env python3
"""A scene of solids and sheets: each does in it what it does alone, and every command knows both.

Usage: test_both_kinds.py SUNDER SOURCE_DIR   Runs work in a scratch folder and with a ledger of their own.
"""
import json, os, shutil, subprocess, sys, tempfile

from frame_reader import FrameReader

SUNDER, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SCENE = os.path.join(SOURCE, "scenes/both/bar_and_film.lua")
failures, checks = [], 0


def check(condition, text):
    global checks
    checks += 1
    if not condition:
        failures.append(text)
        print("  failed:", text)


def sunder(*arguments, code=0):
    done = subprocess.run([SUNDER, *arguments], capture_output=True, text=True)
    check(done.returncode == code, f"sunder {' '.join(arguments[:2])}: exit {done.returncode}: {done.stderr[-300:]}")
    return done.stdout


class Folder:
    def __enter__(self):
        self.path = tempfile.mkdtemp(prefix="sunder-both-")
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)

    def run(self, label, *arguments):
        out = os.path.join(self.path, label)
        text = sunder("run", SCENE, "--precision", "f64", "--json", "--quiet", "--out", out, "--db", os.path.join(self.path, "ledger.db"),
                      "--set", "particles=2000", *arguments)
        return out, json.loads(text or "{}")


def test_each_does_what_it_does_alone():
    reader = FrameReader(SUNDER)
    with Folder() as folder:
        both, summary = folder.run("both", "--frames", "4")
        solid, _ = folder.run("solid", "--frames", "4", "--set", "kind=solid")
        sheet, _ = folder.run("sheet", "--frames", "4", "--set", "kind=sheet")
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
    with Folder() as folder:
        database = os.path.join(folder.path, "ledger.db")
        whole, _ = folder.run("whole", "--frames", "6")
        part, _ = folder.run("part", "--frames", "3", "--checkpoint-every", "1")
        sunder("run", "--resume", "last", "--frames", "6", "--json", "--quiet", "--db", database)
        for path in ("/solid/position", "/sheet/position", "/solid/velocity", "/sheet/bond_broken"):
            check(reader.read(whole, 6, path) == reader.read(part, 6, path), f"{path} after a resumed run")
        threads, _ = folder.run("threads", "--frames", "6", "--threads", "3")
        for path in ("/solid/position", "/sheet/position"):
            check(reader.read(whole, 6, path) == reader.read(threads, 6, path), f"{path} on three threads")


def test_the_film_tears_and_the_bar_holds():
    with Folder() as folder:
        out, _ = folder.run("tear")
        reader = FrameReader(SUNDER)
        broken = sum(reader.read(out, 36, "/sheet/bond_broken")) - sum(reader.read(out, 0, "/sheet/bond_broken"))
        check(broken > 60, f"the film tears across: {broken} bonds")
        picture = os.path.join(folder.path, "picture.png")
        sunder("render", "last", "--db", os.path.join(folder.path, "ledger.db"), "--out", picture)
        check(os.path.getsize(picture) > 2000, "a picture of both")
        sunder("render", "last", "--db", os.path.join(folder.path, "ledger.db"), "--out", picture, "--colour", "sheet/broken")
        listed = sunder("runs", "list", "--db", os.path.join(folder.path, "ledger.db"))
        check("Bar and film" in listed, "the ledger lists the run")


def test_the_commands_say_that_there_are_both():
    note = "pass through one another"
    check(note in sunder("check", SCENE), "check notes that they do not touch")
    check(note in json.loads(sunder("check", SCENE, "--json"))["notes"][0], "and says so in JSON")
    check(json.loads(sunder("check", SCENE, "--json", "--set", "kind=solid"))["notes"] == [], "no note for solids alone")
    plan = json.loads(sunder("explain", SCENE, "--json"))
    check({"elastic", "linear", "fracture"} <= set(plan["effects_on"]), f"explain names effects of both: {plan['effects_on']}")
    check({"elastic", "linear"} <= set(plan["step_limits"]), "and limits of both")
    check("p2g" in plan["stages"] and "bonds" in plan["stages"], f"and stages of both: {plan['stages']}")
    check(note in sunder("explain", SCENE), "and that they do not touch")


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            before = len(failures)
            try:
                test()
            except (OSError, KeyError, IndexError, ValueError) as error:
                check(False, f"{name}: {error!r}")
            print("ok  " if len(failures) == before else "FAIL", name, flush=True)
    print(f"{checks} checks, {len(failures)} failed")
    sys.exit(1 if failures or not checks else 0)


main()
