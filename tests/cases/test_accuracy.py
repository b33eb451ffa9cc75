#!/usr/bin/env python3
"""sunder accuracy: axes made from the effects' tables, orders that are known, runs that are not made twice, budgets, interruptions.

Usage: test_accuracy.py SUNDER [NAME...]   Each test works in a folder and with a ledger of its own.
"""
import csv, json, os, signal, time

import harness
from harness import SOURCE, check, frames_of, run_tests

PULL = os.path.join(SOURCE, "scenes/solid/tube_pull.lua")
SMALL = ["--set", "particles=500", "--set", "break_stretch=0.02", "--set", "pull=0.6", "--frames", "4"]
WHOLE = ["--set", "particles=500", "--set", "pull=0.6", "--set", "variant=elastic_only", "--frames", "4"]

# Linear tetrahedra under v += Δt f/m, x += Δt v. Velocities stand half a step beside places, so that energies are of first order in Δt;
# places themselves are of second (the leapfrog of Störmer and Verlet).
BAR = """local s = require "sunder"
local p = s.params { particles = 200, duration = 0.5, fps = 10, dt = 5e-3 }
return s.scene { title = "Bar", solids = { { shape = s.box { min = { -1, -0.2, -0.2 }, max = { 1, 0.2, 0.2 } }, discretisation = "tetrahedra",
  material = { density = 1, elastic = { E = 10, nu = 0.3 } },
  velocity = function(x, y, z) return 0.05 * math.sin(math.pi * x / 2), 0, 0 end } } }
"""

# The same of bonds, which one end also warms.
FILM = """local s = require "sunder"
local p = s.params { dx = 0.1, duration = 1, fps = 10, dt = 5e-3 }
return s.scene { title = "Film", sheets = { { shape = s.rectangle { size = { 2, 1 } }, thickness = 0.1,
  material = { density = 1, linear = { E = 10, nu = 0.3 }, diffusion = { k = 0.05 } },
  sources = { { value = 1, shape = s.box { center = { 1, 0, 0 }, size = { 1, 3, 3 } } } },
  velocity = function(x, y, z) return 0.05 * math.sin(math.pi * x / 2), 0, 0 end } } }
"""

# A source in the middle of a block.
WET = """local s = require "sunder"
local p = s.params { particles = 300, duration = 0.4, fps = 10 }
return s.scene { title = "Wet", solids = { { shape = s.box { size = { 1, 0.4, 0.4 } }, sources = { { shape = s.sphere { radius = 0.2 }, value = 1 } },
  material = { density = 1, elastic = { E = 10, nu = 0.3 }, diffusion = { k = 0.05 } } } } }
"""


class Box(harness.Box):
    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def ends(self, expected, *arguments):
        """What a command says and complains of, which must end with this exit code."""
        code, out, err = self.call(*arguments)
        check(code == expected, f"{arguments}: exit code {code}, expected {expected}: {err[-400:]}")
        return out, err

    def study(self, *arguments):
        return json.loads(self.ends(0, "accuracy", *arguments, "--threads", "1", "--quiet", "--json")[0])


def axis(study, name):
    return next(a for a in study["axes"] if a["name"] == name)


def names(study):
    return [a["name"] for a in study["axes"] if a["levels"]]


def test_orders_are_those_of_the_integrator():
    with Box() as box:
        study = box.study(box.write("bar.lua", BAR), "--precision", "f64", "--axis", "step", "--levels", "4")
        step = axis(study, "step")
        check(abs(step["orders"]["energy"] - 1) < 0.1, f"energies are of first order in the step: {step['orders']}")
        check(abs(step["orders"]["position"] - 2) < 0.25, f"places of second: {step['orders']}")
        errors = [level["errors"]["energy"] for level in step["levels"]]
        check(len(errors) == 4 and errors[-1] == 0 and errors == sorted(errors, reverse=True), f"finer is better: {errors}")
        sizes = [level["h"] for level in step["levels"]]
        check(all(abs(a / b - 2) < 1e-6 for a, b in zip(sizes, sizes[1:])), f"steps are halved: {sizes}")
        # An error that goes with h is 4, 2, 1 times what is left, less the reference's own: 7/3 from the coarsest to the next but one.
        check(abs(errors[0] / errors[1] - 7 / 3) < 0.3, f"as the order has it: {errors}")
        check(abs(step["left"]["energy"] / errors[2] - 1) < 0.15, f"the finest lacks what it took away: {step['left']}, {errors}")
        film = axis(box.study(box.write("film.lua", FILM), "--precision", "f64", "--axis", "step", "--levels", "4"), "step")
        check(abs(film["orders"]["energy"] - 1) < 0.1 and abs(film["orders"]["position"] - 2) < 0.25, f"the sheet's are the same: {film['orders']}")
        check(film["levels"][0]["errors"]["diffused"] > 0, "what diffuses is compared")


def test_what_diffuses_in_solids_is_compared():
    with Box() as box:
        scene = box.write("wet.lua", WET)
        step = axis(box.study(scene, "--precision", "f64", "--axis", "resolution", "--levels", "2"), "resolution")
        check(step["levels"][0]["errors"]["diffused"] > 0, f"two grids, two distributions: {step['levels'][0]['errors']}")
        totals = [total for total, in box.rows("SELECT value FROM measures_view WHERE name = 'diffused_total' ORDER BY id, frame")]
        check(len(totals) == 2 * 5 and totals[4] > 1.1 * totals[0] > 0, f"the ledger has how much there is: {totals}")


def test_precision_is_round_off():
    with Box() as box:
        study = box.study(PULL, *WHOLE, "--axis", "precision")
        own, fine = axis(study, "precision")["levels"]
        check(own["own"] and own["value"] == "f32" and fine["value"] == "f64" and fine["reference"], "f64 is finer than f32")
        check(0 < own["errors"]["position"] < 1e-5, f"places differ by round-off: {own['errors']}")
        check(0 < own["error"] < 1e-3, f"energies too: {own}")
        check([a["name"] for a in study["axes"]] == ["precision"], "no other axis than that asked for")


def test_axes_come_from_the_effects():
    with Box() as box:
        bar = box.write("bar.lua", BAR)
        check(names(box.study(bar, "--list", "--axis", "all")) == ["resolution", "step", "precision"], "a bar of tetrahedra has no kernels and no damage")
        elastic = names(box.study(PULL, *WHOLE, "--list"))
        check(elastic == ["resolution", "step", "precision", "kernel"], f"no axis of damage without damage: {elastic}")
        full = names(box.study(PULL, *SMALL, "--list"))
        check("damage.form" in full and "laplacian" in full and "damage.tolerance" not in full, f"with damage, in its explicit form: {full}")
        implicit = box.study(PULL, *SMALL, "--set", "form=implicit", "--list")
        check([level["value"] for level in axis(implicit, "damage.tolerance")["levels"]] == ["0.001", "0.0001", "1e-05"], "the implicit form has a tolerance")
        check(box.rows("SELECT count(*) FROM runs") == [(0,)], "who only looks runs nothing")
        err = box.ends(2, "accuracy", bar, "--axis", "resolutoin")[1]
        check("did you mean 'resolution'" in err, f"the nearest axis: {err}")
        err = box.ends(2, "accuracy", bar, "--axis", "laplacian")[1]
        check("an axis of this scene: resolution step precision" in err, f"axes that it has: {err}")
        check("did you mean 'energy'" in box.ends(2, "accuracy", bar, "--measure", "enery")[1], "the nearest measure")
        box.ends(2, "accuracy")
        box.ends(2, "accuracy", bar, "--levels", "1")
        box.ends(2, "accuracy", box.path("nowhere.lua"))


def test_runs_are_not_made_twice():
    with Box() as box:
        words = [PULL, *SMALL, "--axis", "resolution", "--axis", "kernel"]
        first = box.study(*words)
        check(first["done"] == 4 and first["done_before"] == 0 and first["failed"] == 0, f"the scene's own, two beside it, one kernel: {first}")
        check(box.rows(f"SELECT count(*) FROM tags WHERE tag = '{first['tag']}'") == [(4,)], "tagged")
        again = box.study(*words)
        check(again["done"] == 0 and again["done_before"] == 4, "nothing is made again")
        check(box.rows("SELECT count(*) FROM runs") == [(4,)], "four runs in the ledger")
        for a, b in zip(first["axes"], again["axes"]):
            check([level["errors"] for level in a["levels"]] == [level["errors"] for level in b["levels"]], "the same errors")
            check([level["step_s"] for level in a["levels"]] == [level["step_s"] for level in b["levels"]], "the same seconds")
        listed = box.ends(0, "runs", "list", "--where", "tags LIKE '%accuracy:tube_pull%'", "--json")[0]
        check(len(json.loads(listed)["runs"]) == 4, "found by their tag")
        together = box.study(PULL, *SMALL, "--axis", "step", "-j", "2")
        check(not together["times_comparable"] and together["done"] == 2 and together["done_before"] == 1, f"two at a time: {together['done']}")
        alone = box.study(PULL, *SMALL, "--axis", "step")
        check(alone["times_comparable"] and alone["done"] == 2, "whose times are not taken for a study's")
        out = box.study(PULL, *SMALL, "--axis", "precision", "--out", box.path("kept"))
        check(sorted(os.listdir(box.path("kept"))) == ["precision-f64"] and out["done"] == 1, "a folder of one's choice")


def test_a_budget_takes_the_finest_away():
    with Box() as box:
        words = [PULL, *SMALL, "--axis", "resolution", "--levels", "9", "--list"]
        whole = box.study(*words)
        # What runs cost is measured by a few steps, anew each time, and may be several times what was measured before: of these budgets, all between the
        # whole study and the scene's own run, thousands of times cheaper, one leaves some levels out and some in.
        some = False
        for share in (2, 8, 32, 128, 512):
            budget = whole["predicted_s"] / share
            code, out, err = box.call("accuracy", *words, "--budget", str(budget), "--json")
            if code == 2:
                check("--budget: expected at least" in err, f"too little for the scene's own run: {err}")
                continue
            less = json.loads(out)
            check(code == 0 and less["predicted_s"] <= budget, f"the budget of {budget} holds: {less['predicted_s']}")
            values = [[float(level["value"]) for level in axis(s, "resolution")["levels"] if level["status"] == "not started"] for s in (whole, less)]
            check(set(values[1]) <= set(values[0]), f"nothing is added: {values}")
            check(share < 8 or max(values[1], default=0) < max(values[0]), f"the finest level, more than half of the study, is left out: {values}")
            out = [note for note in less["notes"] if "left out by the budget: particles" in note]
            check(bool(out) == (len(values[1]) < len(values[0])), f"and that is said: {less['notes']}")
            some = some or 0 < len(values[1]) < len(values[0])
        check(some, "some levels are left out")
        err = box.ends(2, "accuracy", *words, "--budget", "1e-9")[1]
        check("--budget: expected at least" in err, f"one that not even the scene's own run fits: {err}")


def second_run_under_way(box, dt):
    """A study whose other runs than the scene's own have this step; the process when the first of them is under way, and the scene."""
    steps = f'title = "Bar", dt = p.particles ~= 200 and {dt} or 5e-3'
    scene = box.write("bar.lua", BAR.replace("fps = 10, dt = 5e-3", "fps = 100").replace('title = "Bar"', steps))
    process = box.start("accuracy", scene, "--axis", "resolution", "--threads", "1")
    while process.poll() is None and not (box.output_of(1) and [row[0] for row in box.rows("SELECT status FROM runs ORDER BY run")] == ["done", "running"]):
        time.sleep(0.01)
    return process, scene


def test_an_interrupted_study_goes_on():
    with Box() as box:
        process, scene = second_run_under_way(box, 3e-7)  # half a minute, in frames short enough to be stopped between
        process.send_signal(signal.SIGINT)
        err = process.communicate()[1]
        check(process.returncode == 130 and "interrupted" in err, f"interrupted: {process.returncode} {err}")
        states = [row[0] for row in box.rows("SELECT status FROM runs ORDER BY run")]
        check(states == ["done", "interrupted"], f"what is done is kept, the third is not begun: {states}")
        levels = axis(box.study(scene, "--axis", "resolution", "--list"), "resolution")["levels"]
        states = {level["value"]: level["status"] for level in levels}
        check(states == {"100": "not started", "200": "done before", "400": "not started"}, f"it would go on from there: {states}")


def test_a_second_interruption_does_not_wait_for_the_frame():
    with Box() as box:
        process, _ = second_run_under_way(box, 3e-9)  # a frame of three million steps takes minutes
        while process.poll() is None and frames_of(box.output_of(1)) != [0]:
            time.sleep(0.01)
        while process.poll() is None:  # again and again: two that come before it has looked at one are one
            process.send_signal(signal.SIGINT)
            time.sleep(0.2)
        process.communicate()
        check(process.returncode == 130, f"interrupted: {process.returncode}")


def test_tables_for_people_and_programs():
    with Box() as box:
        table = box.path("levels.csv")
        out = box.ends(0, "accuracy", PULL, *SMALL, "--axis", "precision", "--axis", "kernel", "--csv", table, "--threads", "1")[0]
        check(max(len(line) for line in out.splitlines()) <= 80, f"80 columns:\n{out}")
        for word in ("precision:", "kernel:", "error against seconds", "worth their time", "from f32 to f64 takes"):
            check(word in out, f"'{word}' is said:\n{out}")
        with open(table, encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if line[0] != "#"))
        check([row["value"] for row in rows] == ["f32", "f64", "quadratic", "cubic"], "a row a level")
        check([row["settings"] for row in rows] == ["", "--precision f64", "", "--set kernel=cubic"], "how each is run")
        check(all(float(row["step_s"]) > 0 and len(row["run"]) > 10 for row in rows), "with seconds and run")


run_tests(globals())
