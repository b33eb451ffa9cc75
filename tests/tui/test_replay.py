"""Tuning sessions in the workbench, done again from their command logs without and with a terminal: every run's last state has the same bits.

Usage: test_replay.py SUNDER SCENES [name ...]   Exit codes: 0 passed, 1 failed, 77 skipped (no tmux).
"""
import json
import os
import shutil
import subprocess

import bench
from bench import Bench, check, test


def hashes(s):
    """The last state of each run of a bench's ledger, in order."""
    found = []
    for (folder,) in s.sql("SELECT output FROM runs ORDER BY run"):
        with open(os.path.join(folder, "result.json"), encoding="utf-8") as file:
            found.append(json.load(file)["state_hash"])
    return found


def run_to(s, frame):
    s.do(f"run.run-to {frame}")
    s.wait(rf"frame +{frame}/")
    s.wait(r"paused *$")


def turn(s, path, value):
    s.do(f"run.turn {path}={value}")
    s.wait(rf"{path} = {value}")


def values(recipe):
    """A recipe without its remarks, which name the run."""
    return [line for line in recipe.splitlines() if not line.startswith("--")]


def replays_to_the_same_bits(s, log):
    """The log of the session in `s`, done again without a terminal and with one."""
    wanted = hashes(s)
    check(len(wanted) >= 1 and all(wanted), f"no hashes: {wanted}")
    again = os.path.join(s.folder, "again")
    done = subprocess.run([bench.SUNDER, "--replay", log, "--db", f"{s.folder}/again.db", "--out", again], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=200, cwd=s.folder, check=False)
    got = []
    for i in range(len(wanted)):
        with open(os.path.join(again if i == 0 else f"{again}.{i + 1}", "result.json"), encoding="utf-8") as file:
            got.append(json.load(file)["state_hash"])
    check(got == wanted, f"without a terminal: {got}, not {wanted}\n{done.stderr}")
    with open(os.path.join(f"{again}.{len(wanted)}" if len(wanted) > 1 else again, "commands.log"), encoding="utf-8") as file:
        second = file.read()
    with open(log, encoding="utf-8") as file:
        first = [line for line in file.read().splitlines() if " run.turn " in line]
    check([line for line in second.splitlines() if " run.turn " in line] == first, "the replay's own log has other turns")
    with Bench(replay=log) as other:
        other.wait(r"^END", patience=200)
        check(hashes(other) == wanted, f"with a terminal: {hashes(other)}, not {wanted}")


def tuned_session(start, at_once, paused, running, branched, material):
    """A whole tuning session: knobs turned while paused and while frames go on, a rewind with [ and a branch from there, turns of the branch, its
    material saved as a recipe, and the branch stopped some frames later. Each of the lists is (path, value). The scene has many more frames than
    go by while knobs are turned."""
    with Bench(start) as s:
        first = s.paused().frame()
        for path, value in at_once:
            turn(s, path, value)
        run_to(s, first + 2)
        for path, value in paused:
            turn(s, path, value)
        s.keys("Space")
        s.wait(rf"frame +(?!{first + 2}/)\d+/")
        for path, value in running:
            turn(s, path, value)
        s.do("run.pause on")
        s.wait(r"paused *$")
        s.keys("[")
        s.wait(r"Frame \d+: b goes on from here")
        s.do(f"run.choose {first + 2}")
        s.keys("b")
        s.wait(rf"frame +{first + 2}/")
        s.wait(r"paused *$")
        s.until("the branch", lambda: s.sql("SELECT parent_frame FROM runs WHERE parent_frame IS NOT NULL") == [[first + 2]])
        for path, value in branched:
            turn(s, path, value)
        s.do("run.save-recipe tuned.lua")
        s.wait(r"is in tuned\.lua")
        run_to(s, first + 20)
        s.keys("S")
        s.wait(r"stopped *$")
        s.keys("q")
        s.wait(r"^END")
        turned = [row[0].split(".")[-1] for row in s.sql("SELECT DISTINCT path FROM knob_turns")]
        asked = [path.split(".")[-1] for path, _ in (*at_once, *paused, *running, *branched)]
        check(set(asked) == set(turned), f"turned {asked}, in the ledger {turned}")
        log = os.path.join(s.folder, "session.log")
        shutil.copy(os.path.join(s.sql("SELECT output FROM runs ORDER BY run DESC")[0][0], "commands.log"), log)
        with open(os.path.join(s.folder, "tuned.lua"), encoding="utf-8") as file:
            recipe = file.read()
        check(material in recipe, f"not a recipe of {material}: {recipe}")
        os.remove(os.path.join(s.folder, "tuned.lua"))
        untouched = hashes(s)
        check(len(set(untouched)) == 2, f"the branch is as its parent: {untouched}")
        replays_to_the_same_bits(s, log)
        with open(os.path.join(s.folder, "tuned.lua"), encoding="utf-8") as file:
            check(values(file.read()) == values(recipe), "the replay saved another recipe")


@test
def a_solid_is_tuned():
    tuned_session("solid/tube_pull.lua --set particles=1500 --set duration=100 --paused", at_once=[("eta", "0.3")],
                  paused=[("break_stretch", "0.2"), ("alpha", "-0.5"), ("gamma", "6")], running=[("residual", "0.05")],
                  branched=[("sigma_c", "40"), ("eta", "0.2")], material="sigma_c")


@test
def a_sheet_with_a_source_is_tuned():
    tuned_session("sheet/paper_towel.lua --set particles=900 --set variant=wet --frames 5000 --paused", at_once=[("sources.1.strength", "0.5")],
                  paused=[("fracture.G", "1.5"), ("swelling.alpha", "0.1"), ("diffusion.k", "0.8")], running=[("sources.1.strength", "2")],
                  branched=[("sources.1.strength", "0"), ("softening.stiffness", "1")], material="diffusion")


@test
def a_diffusion_source_is_turned():
    with Bench("sheet/paper_towel.lua --set particles=900 --set variant=wet --frames 60 --paused") as s:
        s.paused()
        turn(s, "sources.1.strength", "0.5")
        run_to(s, 10)
        turn(s, "strength", "3")
        s.keys("Space")
        s.wait(r"done *$", patience=60)
        s.keys("q")
        s.wait(r"^END")
        log = os.path.join(s.sql("SELECT output FROM runs")[0][0], "commands.log")
        kept = os.path.join(s.folder, "kept.log")
        shutil.copy(log, kept)
        turned = s.sql("SELECT path, frame FROM knob_turns")
        check(len(turned) == 2 and turned[0][1] < turned[1][1], f"in the ledger: {turned}")
        replays_to_the_same_bits(s, kept)


@test
def what_is_said_about_runs_is_said_of_the_same_ones():
    """Remarks about the rows of the Runs screen, by its cursor and marks: a replay, whose runs have other names, makes them about its own."""
    with Bench("solid/tube_pull.lua --set particles=900 --frames 2") as s:
        s.wait(r"done *$")
        s.do(f"start {bench.SCENES}/solid/tube_pull.lua --set particles=900 --set eta=0.3 --frames 2")
        s.until("two runs", lambda: s.sql("SELECT status FROM runs") == [["done"], ["done"]])
        s.do("screen runs")
        s.wait(r"2 of 2 runs")
        s.keys("Down")
        s.do("runs.tag first")
        s.wait(r"first on 1 run")
        s.keys("Up", "Space")
        s.wait(r"1 marked")
        s.do("runs.tag second")
        s.wait(r"second on 1 run")
        tags = s.sql("SELECT tag, run FROM tags ORDER BY tag")
        check(tags == [["first", 1], ["second", 2]], f"tags: {tags}")
        s.keys("q")
        s.wait(r"^END")
        log = os.path.join(s.sql("SELECT output FROM runs ORDER BY run DESC")[0][0], "commands.log")
        kept = os.path.join(s.folder, "kept.log")
        shutil.copy(log, kept)
        with open(kept, encoding="utf-8") as file:
            text = file.read()
        check("runs.choose @1\n" in text and "runs.mark @2\n" in text, f"runs by their order: {text}")
        check(" start solid/tube_pull.lua " in text and bench.SCENES not in text, f"scenes by their names: {text}")
        with Bench(replay=kept) as other:
            other.wait(r"^END|done *$", patience=100)
            other.until("its tags", lambda: other.sql("SELECT tag, run FROM tags ORDER BY tag") == tags)


@test
def a_stop_is_replayed_at_its_frame():
    with Bench("solid/tube_pull.lua --set particles=1500 --set duration=100 --precision f64") as s:
        s.wait(r"frame +([3-9]|\d\d+)/")
        s.do("run.turn eta=0.2")
        s.wait(r"eta = 0.2")
        s.keys("C-c")
        s.wait(r"^END")
        log = os.path.join(s.sql("SELECT output FROM runs")[0][0], "commands.log")
        kept = os.path.join(s.folder, "kept.log")
        shutil.copy(log, kept)
        with open(kept, encoding="utf-8") as file:
            check("quit stop" in file.read(), "the stop is not in the log")
        replays_to_the_same_bits(s, kept)


@test
def turns_known_beforehand_are_in_the_log():
    with Bench("solid/tube_pull.lua --set particles=900 --frames 12 --turn 2:eta=0.2 --turn 9:break_stretch=0.1") as s:
        s.wait(r"done *$", patience=60)
        s.keys("q")
        s.wait(r"^END")
        kept = os.path.join(s.folder, "kept.log")
        shutil.copy(os.path.join(s.sql("SELECT output FROM runs")[0][0], "commands.log"), kept)
        check(len(s.sql("SELECT 1 FROM knob_turns")) == 2, "the turns are not in the ledger")
        replays_to_the_same_bits(s, kept)


@test
def the_log_of_a_killed_session_goes_on_to_the_end():
    with Bench("sheet/seaweed.lua --set particles=900 --frames 12") as s:
        s.wait(r"frame +([2-9]|1\d)/")
        log = os.path.join(s.folder, "part.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("".join(line for line in s.commands().splitlines(True) if "start" in line or line.startswith("#")))
        s.wait(r"done *$", patience=60)
        s.keys("q")
        s.wait(r"^END")
        wanted = hashes(s)
        again = os.path.join(s.folder, "again")
        subprocess.run([bench.SUNDER, "--replay", log, "--db", f"{s.folder}/again.db", "--out", again], stdin=subprocess.DEVNULL, timeout=100,
                       capture_output=True, cwd=s.folder, check=True)
        with open(os.path.join(again, "result.json"), encoding="utf-8") as file:
            check(json.load(file)["state_hash"] == wanted[0], "the bits differ")


@test
def wrong_logs_are_refused_with_their_line():
    with Bench("solid/tube_pull.lua --set particles=900 --frames 2") as s:
        s.wait(r"done *$")
        for text, line, word in (("- start tube_pull --set particles=900 --frames 3\n1 run.turn eta=-1\n", 2, "eta"), ("# a remark\nnonsense\n", 2, "FRAME ACTION"),
                                 ("- run.nonsens\n", 1, "run.nonsens"), ("- start nosuchscene\n", 1, "nosuchscene")):
            path = os.path.join(s.folder, "wrong.log")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            done = subprocess.run([bench.SUNDER, "--replay", path, "--db", f"{s.folder}/wrong.db"], stdin=subprocess.DEVNULL, capture_output=True,
                                  text=True, timeout=60, cwd=s.folder, env=dict(os.environ, XDG_DATA_HOME=s.folder), check=False)
            check(done.returncode == 2, f"exit code {done.returncode} for {text!r}: {done.stderr}")
            check(word in done.stderr and (f"wrong.log:{line}" in done.stderr or word == "nosuchscene"), f"for {text!r}: {done.stderr}")


@test
def config_binds_keys_and_wrong_ones_are_told():
    config = 'return {\n  theme = "light",\n  keys = { ["ctrl-n"] = "run.turn eta=0.125", F9 = "screen console", g = false },\n  styles = { good = 200 },\n}\n'
    with Bench("solid/tube_pull.lua --set particles=900 --paused", config=config) as s:
        s.paused()
        check("48;5;254" in s.text(True), "not the light theme")
        s.keys("C-n")
        s.wait(r"eta = 0\.125 from")
        s.keys("g")
        s.wait(r"printed by libraries", absent=True)
        s.keys("?", *["NPage"] * 12)
        s.shows(r"your own", r"ctrl-n +run\.turn eta=0\.125", r" g +nothing")
        s.keys("?")
        s.keys("F9")
        s.wait(r"\[Console\]")
    for wrong, message in (('return {\n  keys = {\n    F9 = "run.pausse" },\n}\n', r"(?s)config\.lua:3: .*run\.pause"),
                           ('return {\n  theme = "lightt" }\n', r"(?s)config\.lua:2: theme.*light"), ("return {\n  keys = { }\n", r"(?s)config\.lua:\d"),
                           ('return {\n  keyz = {} }\n', r"(?s)config\.lua:\d.*keys"), ('return {\n\n  styles = { goood = 3 } }\n', r"(?s)config\.lua:3.*good")):
        with Bench("solid/tube_pull.lua --set particles=900 --paused", config=wrong) as s:
            s.wait(message)
            s.paused()


if __name__ == "__main__":
    bench.run_tests(__doc__)
