#!/usr/bin/env python3
"""Turns of knobs, branches and the ring of checkpoints, as the command line has them.

A run with turns has the same bits as any other that was given them: on other threads, after a kill and a resume, as a branch of one that was not.

Usage: test_turns.py SUNDER [NAME...]   Each test works in a folder and with a ledger of its own.
"""
import glob, json, os, shutil, signal

import harness
from harness import SOURCE, check, checkpoints_of, frames_of, run_tests

PULL = os.path.join(SOURCE, "scenes/solid/tube_pull.lua")
TOWEL = os.path.join(SOURCE, "scenes/sheet/paper_towel.lua")
SMALL = ["--set", "particles=1500", "--set", "break_stretch=0.02", "--set", "pull=0.6"]
WET = ["--set", "variant=wet", "--set", "dx=0.06", "--set", "pull=1"]
TURNS = ["2:eta=0.01", "2:tube.fibres.gamma=25", "4:break_stretch=0.01", "5:gravity=0,-3,0"]
WET_TURNS = ["1:sources.1.strength=3", "2:softening.stiffness=0.9", "3:diffusion.k=2"]


class Box(harness.Box):
    def good(self, *arguments):
        code, result, err = self.run(*arguments)
        check(code == 0, f"{' '.join(arguments)}: exit code {code}: {err}")
        return result


def turned(turns):
    return [word for turn in turns for word in ("--turn", turn)]


def test_turns_give_the_same_bits_on_any_number_of_threads():
    with Box() as box:
        for scene, settings, turns in ((PULL, SMALL, TURNS), (TOWEL, WET, WET_TURNS)):
            for precision in ("f32", "f64"):
                base = [scene, *settings, "--frames", "6", "--precision", precision]
                plain = box.good(*base)
                hashes = {box.good(*base, *turned(turns), "--threads", str(n))["state_hash"] for n in (1, 2, 3)}
                check(len(hashes) == 1, f"{os.path.basename(scene)} {precision}: {hashes}")
                check(plain["state_hash"] not in hashes, f"{os.path.basename(scene)} {precision}: the turns changed the run")


def test_turns_are_told():
    with Box() as box:
        result = box.good(PULL, *SMALL, "--frames", "6", *turned(TURNS))
        check(result["turns"] == 4, f"four turns in the summary: {result['turns']}")
        told = json.load(open(os.path.join(result["out"], "turns.json")))["turns"]
        expected = [(2, "tube.damage.eta", "0.01"), (2, "tube.fibres.gamma", "25"), (4, "tube.damage.break_stretch", "0.01"), (5, "gravity.acceleration", "0,-3,0")]
        check([(t["frame"], t["path"], t["value"]) for t in told] == expected, f"turns.json: {told}")
        rows = box.rows("SELECT frame, path, value FROM knob_turns ORDER BY turn")
        check(rows == expected, f"rows: {rows}")
        events = box.rows("SELECT frame, text FROM events WHERE kind = 'knob' ORDER BY event")
        check([e[0] for e in events] == [2, 2, 4, 5] and "tube.damage.eta: " in events[0][1] and events[0][1].endswith("-> 0.01"), f"events: {events}")


class Whole:
    """Hashes of a run that was never stopped, at any frame."""

    def __init__(self, box, *arguments):
        self.box, self.arguments, self.hashes = box, arguments, {}

    def __getitem__(self, frame):
        if frame not in self.hashes:
            self.hashes[frame] = self.box.good(*self.arguments, "--frames", str(frame))["state_hash"]
        return self.hashes[frame]


def killed_and_resumed(box, frame, target, *arguments):
    """Kills a run once it has written a frame, and lets it go on up to frame `target`, or one beyond the last that was written."""
    code, folder = box.stop_after(signal.SIGKILL, frame, *arguments)
    check(code == -signal.SIGKILL, f"it was under way: {code}")
    target = max(target, frames_of(folder)[-1] + 1)
    again = box.good("--resume", os.path.basename(folder), "--threads", "1", "--frames", str(target - checkpoints_of(folder)[-1]))
    check(frames_of(again["out"]) == list(range(target + 1)), f"frames after a kill, up to {target}: {frames_of(again['out'])}")
    return again, target


def test_a_killed_run_goes_on_with_its_turns():
    with Box() as box:
        for scene, settings, turns, precision in ((PULL, SMALL, TURNS, "f32"), (PULL, SMALL, TURNS, "f64"), (TOWEL, WET, WET_TURNS, "f32")):
            base = [scene, *settings, *turned(turns), "--precision", precision]
            whole = Whole(box, *base)
            for frame in (1, 3, 5):
                again, target = killed_and_resumed(box, frame, 8, *base, "--threads", "2")
                run = again["run_id"]
                check(again["state_hash"] == whole[target], f"{os.path.basename(scene)} {precision}: killed after frame {frame}")
                check(box.rows("SELECT count(*) FROM knob_turns JOIN runs USING (run) WHERE id = ?", run)[0][0] == len(turns), "the turns' rows after a kill")
                check(box.rows("SELECT count(*) FROM events JOIN runs USING (run) WHERE id = ? AND kind = 'knob'", run)[0][0] == len(turns), "each turn is told once")


def test_a_resumed_run_takes_further_turns():
    with Box() as box:
        whole = box.good(PULL, *SMALL, "--frames", "8", *turned(TURNS))
        part = box.good(PULL, *SMALL, "--frames", "3", *turned(TURNS[:2]))
        code, _, err = box.run("--resume", part["run_id"], "--frames", "5", *turned(["2:eta=0.5"]))
        check(code == 2 and "from 3" in err, f"a turn in the past of a resumed run: {code} {err}")
        check(frames_of(part["out"]) == [0, 1, 2, 3] and checkpoints_of(part["out"])[-1] == 3, "what was refused has touched nothing")
        again = box.good("--resume", part["run_id"], "--frames", "5", *turned(TURNS[2:]))
        check(again["state_hash"] == whole["state_hash"], "turns given when it was resumed")
        # Without its list a run still knows what had acted.
        part = box.good(PULL, *SMALL, "--frames", "6", *turned(TURNS))
        os.remove(os.path.join(part["out"], "turns.json"))
        again = box.good("--resume", part["run_id"], "--frames", "2")
        check(again["state_hash"] == whole["state_hash"], "a run whose turns.json is gone goes on from its checkpoint's turns")
        part = box.good(PULL, *SMALL, "--frames", "6", *turned(TURNS))
        open(os.path.join(part["out"], "turns.json"), "w").write('{"turns": [\n{"frame": 2}]}')
        code, _, err = box.run("--resume", part["run_id"], "--frames", "2")
        check(code == 2 and "turns.json:2" in err, f"a damaged list is named with its line: {code} {err}")


def test_a_branch_is_its_parent():
    with Box() as box:
        for scene, settings, turns in ((PULL, SMALL, TURNS), (TOWEL, WET, WET_TURNS)):
            base = [scene, *settings, "--frames", "7"]
            parent = box.good(*base, *turned(turns[:2]), "--keep", "all", "--threads", "2")
            for frame in (3, 7):
                branch = box.good("--branch", f"{parent['run_id']}@{frame}", "--threads", "1")
                check(branch["state_hash"] == parent["state_hash"], f"a branch at {frame} without turns of its own")
                check(branch["parent"] == parent["run_id"] and branch["parent_frame"] == frame and branch["run_id"] != parent["run_id"], "its own row")
                check(frames_of(branch["out"]) == list(range(8)), f"frames of a branch at {frame}: {frames_of(branch['out'])}")
                row = box.rows("SELECT parent, parent_frame, scene_path FROM runs WHERE id = ?", branch["run_id"])[0]
                check(row == (parent["run_id"], frame, scene), f"row of a branch: {row}")
                counts = {run: box.rows("SELECT frame, kinetic.value FROM frames JOIN runs USING (run) JOIN run_measures AS kinetic USING (run, frame) JOIN measures USING (measure) "
                                        "WHERE id = ? AND name = 'kinetic' ORDER BY frame", run) for run in (parent["run_id"], branch["run_id"])}
                check(counts[parent["run_id"]] == counts[branch["run_id"]] and len(counts[branch["run_id"]]) == 8, "the past's measures are its own too")
            straight = box.good(*base, *turned(turns))
            branch = box.good("--branch", f"{parent['run_id']}@3", *turned(turns[2:]))
            check(branch["state_hash"] == straight["state_hash"], "a branch with turns is a run with all the turns")
            check(len(json.load(open(os.path.join(branch["out"], "turns.json")))["turns"]) == len(turns), "a branch has its parent's turns in its own list")
            below = box.good("--branch", f"{branch['run_id']}@1", *turned(turns))
            check(below["state_hash"] == straight["state_hash"], "a branch of a branch, from before where that one left its parent")


def test_a_branch_finds_its_way_from_an_older_checkpoint():
    with Box() as box:
        base = [PULL, *SMALL, "--frames", "7"]
        straight = box.good(*base, *turned(TURNS))
        for keep in (["--checkpoint-every", "5", "--keep", "all"], ["--checkpoint-every", "0"], ["--keep", "1"]):
            parent = box.good(*base, *turned(TURNS[:2]), *keep)
            branch = box.good("--branch", f"{parent['run_id']}@4", *turned(TURNS[2:]))
            check(branch["state_hash"] == straight["state_hash"], f"a branch of a run with {' '.join(keep)}")
            same = [os.path.samefile(os.path.join(parent["out"], "frames", f"{f:06d}.hdf"), os.path.join(branch["out"], "frames", f"{f:06d}.hdf")) for f in range(8)]
            check(same == [True] * 5 + [False] * 3, f"frames of the past are the parent's files: {same}")
            shutil.rmtree(parent["out"])
            code, _, _ = box.call("render", branch["run_id"], "--frame", "2", "--out", box.path("p.png"))
            check(code == 0, "a branch has its frames though its parent's folder is gone")


def test_a_killed_branch_goes_on():
    with Box() as box:
        base = [PULL, *SMALL]
        whole = Whole(box, *base, *turned(TURNS))
        parent = box.good(*base, *turned(TURNS[:2]), "--frames", "9", "--checkpoint-every", "4", "--keep", "all")
        before = sorted((f, os.path.getmtime(os.path.join(parent["out"], f))) for f in ["result.json"] + [f"frames/{k:06d}.hdf" for k in range(10)])
        for frame in (4, 5, 7):
            again, target = killed_and_resumed(box, frame, 9, "--branch", f"{parent['run_id']}@3", *turned(TURNS[2:]))
            check(again["run_id"] != parent["run_id"], "the branch was killed")
            check(again["state_hash"] == whole[target], f"a branch killed after frame {frame}")
        after = sorted((f, os.path.getmtime(os.path.join(parent["out"], f))) for f in ["result.json"] + [f"frames/{k:06d}.hdf" for k in range(10)])
        check(before == after and frames_of(parent["out"]) == list(range(10)), "the parent's folder is as it was")


def test_the_ring_of_checkpoints():
    with Box() as box:
        one = box.good(PULL, *SMALL, "--frames", "1")
        size = os.path.getsize(os.path.join(one["out"], "checkpoint-000001.hdf"))
        limit = int(8.5 * size) // 1024
        result = box.good(PULL, *SMALL, "--frames", "30", "--keep", f"{limit}K")
        kept = checkpoints_of(result["out"])
        total = sum(os.path.getsize(f) for f in glob.glob(os.path.join(result["out"], "checkpoint-*.hdf")))
        check(total <= limit * 1024, f"{total} bytes of {limit * 1024}")
        check(kept[0] == 0 and kept[-2:] == [29, 30] and len(kept) >= 6, f"checkpoints {kept}")
        gaps = [b - a for a, b in zip(kept, kept[1:])]
        check(gaps[0] >= 4 * gaps[-1], f"dense where it is new: gaps {gaps}")
        tight = box.good(PULL, *SMALL, "--frames", "6", "--keep", "1K")
        check(checkpoints_of(tight["out"]) == [0, 5, 6], f"the least that is kept: {checkpoints_of(tight['out'])}")
        check(box.rows("SELECT count(*) FROM events JOIN runs USING (run) WHERE id = ? AND kind = 'warning' AND text LIKE '%--keep%'", tight["run_id"])[0][0] == 1,
              "what cannot be kept to is said once")
        branch = box.good("--branch", f"{result['run_id']}@12")
        check(branch["state_hash"] == result["state_hash"], "a branch from the ring")


def test_what_is_wrong():
    with Box() as box:
        parent = box.good(PULL, *SMALL, "--frames", "3")
        count = box.rows("SELECT count(*) FROM runs")[0][0]
        base = [PULL, *SMALL, "--frames", "3"]
        for arguments, words in (([*base, "--turn", "1:tube.damage.etta=1"], ["tube.damage.eta"]),
                                 ([*base, "--turn", "1:damge.eta=1"], ["eta"]),
                                 ([*base, "--turn", "1:eta=-1"], ["from 0", "-1"]),
                                 ([*base, "--turn", "1:eta=much"], ["a number", "much"]),
                                 ([*base, "--turn", "1:lame=papr"], ["paper"]),
                                 ([*base, "--turn", "3:eta=1"], ["0 up to 2", "3"]),
                                 ([*base, "--turn", "1:density=5"], ["restart", "masses"]),
                                 ([*base, "--turn", "1:damage.form=implicit"], ["restart"]),
                                 ([*base, "--turn", "1:pull=5"], ["restart", "script"]),
                                 ([*base, "--turn", "eta=1"], ["FRAME:PATH=VALUE"]),
                                 ([*base, "--turn", "-1:eta=1"], ["FRAME:PATH=VALUE"]),
                                 ([*base, "--keep", "5Q"], ["--keep", "500M"]),
                                 (["--branch", f"{parent['run_id']}@9"], ["0 to 3", "9"]),
                                 (["--branch", "nothing@1"], ["nothing"]),
                                 (["--branch", "last"], ["RUN@FRAME"]),
                                 (["--branch", "last@2", PULL], ["scene"]),
                                 (["--branch", "last@2", "--set", "eta=1"], ["--turn"]),
                                 (["--branch", "last@2", "--turn", "1:eta=1"], ["from 2"])):
            code, result, err = box.run(*arguments)
            check(code == 2 and result is None, f"{arguments[-2:]}: exit code {code}")
            check(all(word in err for word in words), f"{arguments[-2:]}: {err}")
        check(box.rows("SELECT count(*) FROM runs")[0][0] == count, "what is wrong leaves no row")


run_tests(globals())
