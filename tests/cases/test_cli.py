#!/usr/bin/env python3
"""The command line as its users and their scripts meet it: exit codes, JSON, ledger, frames, resuming, interrupting.

Usage: test_cli.py SUNDER [NAME...]   Each test works in a folder and with a ledger of its own.
"""
import glob, json, os, re, signal, subprocess, time

import harness
from harness import SOURCE, SUNDER, check, checkpoints_of, frames_of, run_tests

PULL = os.path.join(SOURCE, "scenes/solid/tube_pull.lua")
SMALL = ["--set", "particles=1500", "--set", "break_stretch=0.02", "--set", "pull=0.6"]


class Box(harness.Box):
    def statuses(self):
        if not os.path.exists(self.db):
            return []
        return [status for status, in self.rows("SELECT status FROM runs ORDER BY started")]


def test_contract_of_run():
    with Box() as box:
        code, result, err = box.run(PULL, *SMALL, "--frames", "4", "--out", box.path("out"))
        check(code == 0, f"exit code {code}: {err}")
        for key in ("run_id scene status frames steps particles wall_s step_wall_s particle_steps_per_s threads precision effects "
                    "dt_min dt_max time energy momentum angular_momentum damage bytes_per_particle peak_rss_bytes out db crack_normal").split():
            check(key in result, f"'{key}' in the summary")
        check(result["status"] == "done" and result["frames"] == 4, "four frames done")
        check({"kinetic", "elastic"} <= set(result["energy"]), "energies")
        check({"mean", "max", "broken_fraction"} <= set(result["damage"]), "damage")
        check(frames_of(box.path("out")) == list(range(5)), "frames 0 to 4 on disk")
        check(json.load(open(box.path("out/result.json")))["run_id"] == result["run_id"], "result.json is the summary")
        check(os.path.exists(box.path("out/scene/tube_pull.lua")) and os.path.exists(box.path("out/scene/recipes/tube.lua")), "scripts are kept")
        check(abs(result["time"] - 4 / 24) < 1e-12, "time of frame 4")
        check(result["effects"] == ["damage", "elastic", "fibres", "gravity", "boundary"], "effects by name")
        check(box.statuses() == ["done"], "one row, done")
        code, out, _ = box.call("run", PULL, *SMALL, "--frames", "1", "--json")
        json.loads(out)
        check(code == 0, "--json alone: one object on standard output")


def test_variants_turn_effects_off():
    with Box() as box:
        expected = {"full": {"damage", "elastic", "fibres"}, "isotropic": {"damage", "elastic"},
                    "damage_only": {"damage", "elastic"}, "elastic_only": {"elastic", "fibres"}}
        sizes = {}
        for variant, effects in expected.items():
            code, out, err = box.call("explain", PULL, "--set", "particles=1500", "--set", f"variant={variant}", "--json")
            plan = json.loads(out or "{}")
            check(code == 0 and set(plan["effects_on"]) == effects | {"gravity", "boundary"}, f"{variant}: {plan} {err}")
            names = {f["name"] for f in plan["fields"]}
            check(("damage" in names) == ("damage" in effects), f"{variant}: a field of damage only with damage")
            check(any("damage" in stage for stage in plan["stages"]) == ("damage" in effects), f"{variant}: stages of damage only with damage")
            check(plan["dt"] <= min(plan["step_limits"].values()) * 1.0001, f"{variant}: dt within the limits")
            sizes[variant] = plan["bytes_per_particle"]
        check(sizes["elastic_only"] < sizes["full"], "what is off takes no memory")


def test_same_bits_over_threads():
    with Box() as box:
        hashes = {box.run(PULL, *SMALL, "--frames", "6", "--threads", str(n))[1]["state_hash"] for n in (1, 2, 3, 7)}
        check(len(hashes) == 1, f"one hash over threads, found {hashes}")


def test_resume_gives_the_same_bits():
    with Box() as box:
        whole = box.run(PULL, *SMALL, "--frames", "8", "--out", box.path("whole"))[1]
        for stop in (0, 1, 5):
            part = box.run(PULL, *SMALL, "--frames", str(stop), "--out", box.path(f"part{stop}"))[1]
            code, again, err = box.run("--resume", part["run_id"], "--frames", str(8 - stop))
            check(code == 0, f"resume after {stop}: {err}")
            check(again["state_hash"] == whole["state_hash"] and again["steps"] == whole["steps"], f"resumed after frame {stop}: same bits")
            check(again["run_id"] == part["run_id"] and again["frames"] == 8, "the same run goes on")
            check(frames_of(box.path(f"part{stop}")) == frames_of(box.path("whole")), "no frame is missing")


def test_interrupt_and_kill():
    with Box() as box:
        for number, name, expected in ((signal.SIGINT, "interrupted", 130), (signal.SIGKILL, "dead", -signal.SIGKILL)):
            code, folder = box.stop_after(number, 4, PULL, *SMALL)
            check(code == expected, f"{name}: {code}, not {expected}")
            code, out, _ = box.call("runs", "list", "--json")
            check(code == 0 and "running" not in box.statuses(), f"no run is left as running: {box.statuses()}")
            check(box.statuses()[-1] == name, f"{name}: {box.statuses()}")
            run_id = json.loads(out)["runs"][0]["run_id"]
            done = frames_of(folder)[-1]
            code, again, err = box.run("--resume", run_id, "--frames", str(done + 3 - checkpoints_of(folder)[-1]))
            check(code == 0 and again["frames"] == done + 3, f"{name} after {done} frames goes on: {err}")
            whole = box.run(PULL, *SMALL, "--frames", str(done + 3), "--out", box.path(name))[1]
            check(again["state_hash"] == whole["state_hash"], f"{name}: same bits as the run that was never stopped")


def test_no_moment_to_stop_leaves_a_run_as_running():
    with Box() as box:
        for milliseconds in range(20, 200, 12):
            process = box.start_run(PULL, "--set", "particles=20000", "--frames", "1000000", "--out", box.path(str(milliseconds)))
            time.sleep(milliseconds / 1000)
            process.send_signal(signal.SIGTERM)
            process.communicate()
            states = box.statuses() if os.path.exists(box.db) else []
            check(set(states) <= {"interrupted"}, f"stopped after {milliseconds} ms: {states}")


def test_a_dead_run_goes_on_to_the_frames_first_asked_for():
    with Box() as box:
        whole = box.run(PULL, *SMALL, "--frames", "8", "--keep", "all", "--out", box.path("out"))[1]
        # What a kill after frame 5 leaves.
        for frame in range(6, 9):
            os.remove(box.path(f"out/frames/{frame:06d}.hdf"))
            os.remove(box.path(f"out/checkpoint-{frame:06d}.hdf"))
        os.remove(box.path("out/result.json"))
        box.rows("UPDATE runs SET status = 'dead'")
        code, again, err = box.run("--resume", whole["run_id"])
        check(code == 0 and again["frames"] == 8 and again["state_hash"] == whole["state_hash"], f"up to the eighth: {err}")


def test_wrong_scenes():
    with Box() as box:
        endless = 0
        for path in sorted(glob.glob(os.path.join(SOURCE, "tests/cases/wrong/*.lua"))):
            name = os.path.basename(path)
            with open(path, "rb") as file:
                bomb = b"processor time" in file.readline()
            endless += bomb
            # Scripts that only the clock ends take 5 s each: here one of them; tests/unit/test_script_wrong.c gives all of them little time.
            if bomb and endless > 1:
                continue
            code, out, err = box.call("run", path, "--quiet", "--frames", "1")
            check(code == 2, f"{name}: exit code {code}, {err.strip()[:200]}")
            check(re.search(r"(%s|recipes/\w+\.lua):\d+: " % re.escape(name), err), f"{name}: the message names file and line: {err.strip()[:200]}")
        check(endless > 1, "scripts that never end are among them")
        code, _, err = box.call("run", box.path("no_such_scene.lua"))
        check(code == 2 and "no_such_scene.lua" in err, f"missing file: {code} {err}")
        check(box.statuses() == [], f"no row for a scene that is wrong: {box.statuses()}")


def test_wrong_while_running():
    with Box() as box:
        for path in sorted(glob.glob(os.path.join(SOURCE, "tests/cases/wrong_running/*.lua"))):
            name = os.path.basename(path)
            code, _, err = box.call("run", path, "--quiet", "--out", box.path(name))
            check(code == 2, f"{name}: exit code {code}, {err.strip()[:200]}")
            check(re.search(re.escape(name) + r":\d+", err), f"{name}: file and line: {err.strip()[:200]}")
            check(len(frames_of(box.path(name))) >= 1, f"{name}: frames before the trouble are kept")
        check(set(box.statuses()) <= {"failed"}, f"runs that failed say so: {box.statuses()}")


def test_warnings_outlive_short_runs():
    """However soon a run ends, and however it does, its warnings have been told."""
    with Box() as box:
        for settings, wanted in ((["--set", "dt=0.02", "--frames", "2"], 0), (["--set", "dt=1"], 1)):
            code, out, _ = box.call("run", PULL, "--set", "particles=500", *settings)
            check(code == wanted and out.count("warning: dt 0.0") == 1, f"{settings}: exit code {code}: {out[:300]}")


def test_check_says_what_is_wrong():
    with Box() as box:
        scene = box.path("typo.lua")
        with open(scene, "w") as out:
            out.write('local s = require "sunder"\nreturn s.scene {\n  solids = { { shape = s.sphere { center = {0,0,0}, radius = 1 },\n'
                      '    material = { density = 1,\n      elastic = { E = 1, nuu = 0.3 } } } } }\n')
        code, out, _ = box.call("check", scene, "--json")
        report = json.loads(out)
        check(code == 2 and report["ok"] is False, "a typo is an error")
        first = report["errors"][0]
        check(first["nearest"] == "nu" and first["line"] and "typo.lua" in first["file"], f"file, line and nearest name: {first}")
        code, out, _ = box.call("check", PULL, "--json")
        check(code == 0 and json.loads(out) == {"ok": True, "errors": [], "notes": []}, "a right scene is ok")
        for wrong in (["run"], ["run", PULL, "--frames", "many"], ["run", PULL, "--set", "etta=1"], ["run", PULL, "--precision", "f16"],
                      ["run", PULL, "--simd", "neon9"], ["rum", PULL], ["runs", "lits"], ["check"], ["run", PULL, "--frobnicate"]):
            code, _, err = box.call(*wrong)
            check(code == 2 and err.strip(), f"{wrong}: exit code {code}: {err.strip()[:120]}")
        check("eta" in box.call("run", PULL, "--set", "etta=1")[2], "--set names the nearest knob")


def test_commands_say_how_they_are_called():
    with Box() as box:
        commands = re.findall(r"^ {2}sunder (\w+) ", box.call("help")[1], re.M)
        check(len(commands) > 10, f"commands of sunder help: {commands}")
        for command in commands:
            for words in ([command, "-h"], [command, "anything", "--help"]):
                code, out, err = box.call(*words)
                check(code == 0 and f"usage: sunder {command}" in out and not err, f"{words}: exit code {code}: {out[:80]}{err[:80]}")
            check(box.call("help", command)[:2] == (code, out) or command == "help", f"sunder help {command} says the same")
        code, _, err = box.call("help", "rnu")
        check(code == 2 and "'run'" in err, f"help for what is not there: {code}: {err}")
        code, out, _ = box.call("runs", "list", "--where", "status='--help'")
        check(code == 0 and "usage" not in out, "a word that holds --help is none")


def test_paused_is_the_workbenches():
    with Box() as box:
        code, _, err = box.call("run", PULL, *SMALL, "--frames", "1", "--paused")
        check(code == 2 and "--tui" in err, f"exit code {code}: {err[:120]}")
        code, result, err = box.run(PULL, *SMALL, "--frames", "1", "--paused", "--tui")
        check(code == 0 and result["frames"] == 1, f"without a terminal it goes on: exit code {code}: {err[:200]}")


def test_runs_diff_shows_what_differs():
    with Box() as box:
        a = box.run(PULL, *SMALL, "--frames", "2")[1]["run_id"]
        b = box.run(PULL, *SMALL, "--frames", "2", "--set", "eta=0.2")[1]["run_id"]
        code, out, err = box.call("runs", "diff", a, b)
        check(code == 0 and "eta" in out, f"eta differs: {out} {err}")
        for same in ("gamma", "alpha", "nu", "seed", "density"):
            check(not re.search(rf"\b{same}\b", out), f"'{same}' is equal and not shown")
        code, out, _ = box.call("runs", "show", a, "--json")
        check(code == 0 and json.loads(out), "show as JSON")
        code, out, _ = box.call("runs", "show", "last")
        check(code == 0 and b in out, "last is the newest")
        code, _, err = box.call("runs", "show", a[:-1] + "x")
        check(code == 2, f"an unknown run: {err}")
        check(box.rows("SELECT count(*) FROM runs") == [(2,)], "the ledger opens as a database")


def test_output_is_never_overwritten():
    with Box() as box:
        box.run(PULL, *SMALL, "--frames", "2", "--out", box.path("out"))
        before = os.stat(box.path("out/frames/000002.hdf")).st_mtime_ns
        code, _, err = box.run(PULL, *SMALL, "--frames", "2", "--out", box.path("out"))
        check(code == 2 and "out" in err, f"a folder that holds a run is refused: {code} {err}")
        check(os.stat(box.path("out/frames/000002.hdf")).st_mtime_ns == before, "and nothing in it is touched")
        code, out, err = box.call("run", PULL, "--frames", "1", "--db", "/dev/null/ledger.db")
        check(code in (1, 2) and "/dev/null" in err, f"a ledger that cannot be: {code} {err}")


def test_output_folder_is_taken_as_it_is_said():
    """A folder without a name, or with one that is too long, is refused: neither is made to be another one."""
    with Box() as box:
        for name in ("", "x/" * 600 + "y"):
            code, _, err = box.call("run", PULL, *SMALL, "--frames", "1", "--out", name)
            check(code == 2 and "--out" in err, f"{name[:8]!r}: exit code {code}: {err[:200]}")
        check(not os.path.exists(box.path("frames")) and not os.path.exists(box.path("x")), f"nothing was written: {os.listdir(box.folder)}")
        deep = "y" * 200 + "/" + "z" * 200 + "/run"
        code, result, err = box.run(PULL, *SMALL, "--frames", "1", "--out", deep)
        check(code == 0 and result["out"].endswith(deep) and len(frames_of(result["out"])) == 2, f"a long name: {code}: {err[:200]}")


def test_output_that_cannot_be_written():
    """What was asked for and got lost is an error; progress that nobody reads is none."""
    with Box() as box:
        for words, wanted in ((["explain", PULL, *SMALL], 1), (["run", PULL, *SMALL, "--frames", "1", "--json", "--quiet"], 1),
                              (["run", PULL, *SMALL, "--frames", "1"], 0)):
            with open("/dev/full", "w") as full:
                done = subprocess.run([SUNDER, *words], env=box.environment, stdout=full, stderr=subprocess.PIPE, text=True)
            check(done.returncode == wanted and ("cannot write the output" in done.stderr) == (wanted == 1), f"{words}: {done}")


def test_functions_of_place_and_notches_resume():
    with Box() as box:
        with open(box.path("vary.lua"), "w") as file:
            file.write("""local s = require "sunder"
return s.scene { particles = 1000, duration = 1, solids = { { name = "bar", shape = s.box { size = { 2, 0.5, 0.5 } },
  notches = { s.box { center = { 0, 0.25, 0 }, size = { 0.2, 0.3, 1 } } },
  material = { density = function(x) return x > 0 and 2 or 1 end, elastic = { E = function(x) return x > 0 and 100 or 20 end },
    damage = { break_stretch = 0.05, eta = 0.1 } } } },
  grips = { { shape = s.box { center = { 1, 0, 0 }, size = { 0.3, 1, 1 } }, velocity = { 1, 0, 0 } },
            { shape = s.box { center = { -1, 0, 0 }, size = { 0.3, 1, 1 } } } } }
""")
        whole = box.run(box.path("vary.lua"), "--frames", "6")[1]
        part = box.run(box.path("vary.lua"), "--frames", "3")[1]
        code, again, err = box.run("--resume", part["run_id"], "--frames", "3")
        check(code == 0 and again["state_hash"] == whole["state_hash"], f"the same bits: {err}")
        plain = box.run(box.path("vary.lua"), "--frames", "6", "--set", "E=100")[1]
        check(plain["state_hash"] != whole["state_hash"], "--set E takes the function's place")
        fields = {f["name"] for f in json.loads(box.call("explain", box.path("vary.lua"), "--json")[1])["fields"]}
        check({"stiffness_scale", "toughness_scale", "density_scale"} <= fields and "viscosity_scale" not in fields, f"only what varies: {fields}")


def write_sweep(box, over, more=""):
    with open(box.path("grid.lua"), "w") as file:
        file.write(f"""local s = require "sunder"
return s.sweep {{ scene = "{PULL}", frames = 2, set = {{ particles = 1500, pull = 0.6 }},
  over = {{ {over} }}{more} }}
""")
    return box.path("grid.lua")


def sweep(box, path, *arguments):
    code, out, err = box.call("sweep", path, *arguments, "--json")
    return code, json.loads(out) if out else None, err


def test_sweep():
    with Box() as box:
        path = write_sweep(box, 'eta = { 0.1, 0.2 }, variant = { "full", "isotropic" }')
        code, first, err = sweep(box, path, "-j", "2")
        check(code == 0 and first["done"] == 4 and len(first["runs"]) == 4, f"four runs: {code} {err}")
        check([tuple(r["settings"].values()) for r in first["runs"]] == [("0.1", "full"), ("0.1", "isotropic"), ("0.2", "full"), ("0.2", "isotropic")],
              "all combinations, the last name fastest")
        listed = json.loads(box.call("runs", "list", "--where", "tags = 'grid' AND status = 'done'", "--json")[1])
        check(len(listed["runs"]) == 4, f"found by their tag: {len(listed['runs'])}")
        shown = box.call("runs", "show", first["runs"][3]["run_id"], "--json")[1]
        check('"isotropic"' in shown and "0.2" in shown, "with their settings")
        path = write_sweep(box, 'eta = { 0.1, 0.2, 0.3 }, variant = { "full", "isotropic" }')
        code, second, err = sweep(box, path)
        check(code == 0 and second["done"] == 2 and second["done_before"] == 4, f"only what is new: {code} {second and second['done']} {err}")
        check({r["run_id"] for r in first["runs"]} < {r["run_id"] for r in second["runs"]}, "the others are the runs of before")
        check(len(box.statuses()) == 6, f"six rows: {box.statuses()}")
    with Box() as box:
        path = write_sweep(box, "eta = { 0.1, -1, 0.2 }")
        code, result, err = sweep(box, path)
        states = [r["status"] for r in result["runs"]]
        check(code == 1 and states == ["done", "failed", "done"], f"one that is wrong does not stop the others: {code} {states}")
        check("eta" in result["runs"][1]["message"] and result["runs"][1]["exit_code"] == 2, f"and says why: {result['runs'][1]}")
        path = write_sweep(box, "eta = { 1e-9, 0.3 }")
        code, result, err = sweep(box, path)
        check(code == 1 and [r["status"] for r in result["runs"]] == ["failed", "done"], f"nor one that fails as it runs: {code} {result}")
        check("implicit" in result["runs"][0]["message"] and result["runs"][0]["run_id"], f"which says why, too: {result['runs'][0]}")


def test_sweep_that_is_wrong():
    with Box() as box:
        for over, more, words in (("etaa = { 1, 2 }", "", ("etaa", "did you mean 'eta'")), ("eta = { 1 }", ", tilte = 'x'", ("grid.lua:3", "did you mean 'title'")),
                                  ("eta = { }", "", ("over.eta", "at least one value")), ("eta = 1", "", ("over.eta", "a list of values")),
                                  ("eta = { {} }", "", ("over.eta[1]", "a number"))):
            code, out, err = box.call("sweep", write_sweep(box, over, more))
            check(code == 2 and all(word in err for word in words), f"{over} {more}: {code} {err}")
        code, out, err = box.call("sweep", PULL)
        check(code == 2 and "s.sweep" in err, f"a scene is no sweep: {code} {err}")
        code, out, err = box.call("run", write_sweep(box, "eta = { 1 }"))
        check(code == 2 and "s.scene" in err, f"a sweep is no scene: {code} {err}")
        check(box.statuses() == [], "and nothing ran")


def test_sweep_stops_and_goes_on():
    with Box() as box:
        def over(durations):
            with open(box.path("grid.lua"), "w") as file:
                file.write(f'return require("sunder").sweep {{ scene = "{PULL}", set = {{ particles = 1500 }}, over = {{ duration = {{ {durations} }} }} }}\n')
        over("0.1, 20000, 0.2")  # the second is under way for as long as it is let
        process = box.start("sweep", box.path("grid.lua"), "--json")
        while process.poll() is None and not (box.output_of(1) and len(frames_of(box.output_of(1))) > 9):
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        process.communicate()
        check(process.returncode == 130, f"stopped: {process.returncode}")
        check(box.statuses() == ["done", "interrupted"], f"its run ends with it, and none begins: {box.statuses()}")
        over("0.1, 0.3, 0.2")
        code, result, err = sweep(box, box.path("grid.lua"))
        check(code == 0 and result["done_before"] == 1 and result["done"] == 2, f"and the rest is done: {code} {result and result['done']} {err}")


def test_render():
    with Box() as box:
        run = box.run(PULL, *SMALL, "--frames", "1")[1]["run_id"]
        code, _, err = box.call("render", run, "--out", box.path("a.png"), "--width", "320", "--height", "200")
        data = open(box.path("a.png"), "rb").read() if code == 0 else b""
        check(code == 0 and data[:4] == b"\x89PNG" and len(data) > 2000, f"a picture: {code} {err}")
        code, _, err = box.call("render", run, "--out", box.path("a.jpg"))
        check(code == 2 and ".png" in err and not os.path.exists(box.path("a.jpg")), f"a PNG of another name: {code} {err}")


run_tests(globals())
