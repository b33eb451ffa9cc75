#!/usr/bin/env python3
"""The command for hard cases: what it calls wrong, what it shows, what the ledger keeps. The hard cases themselves are ctest entries of their own.

Usage: test_stress.py SUNDER [NAME...]
"""
import json, os, subprocess

from harness import SOURCE, SUNDER, Box, check, run_tests

SCENE = """local s = require "sunder"
local p = s.params {{ duration = 0.1, fps = 40, dx = 0.1{params} }}
return s.scene {{
  title  = "Case", gravity = {{ 0, -10, 0 }}, {keys}
  solids = {{ {{ shape = s.box {{ size = {{ 0.2, 0.2, 0.2 }}, center = {{ 0, 0, 0 }} }}, material = {{ density = 1, elastic = {{ E = 1000, nu = 0.3 }} }} }} }},
  expect = {expect},
}}
"""


class Cases(Box):
    """A scratch folder whose scenes/stress holds cases."""

    def __enter__(self):
        super().__enter__()
        os.makedirs(self.path("scenes/stress"))
        return self

    def case(self, name, expect, params="", keys=""):
        with open(self.path(f"scenes/stress/{name}.lua"), "w", encoding="utf-8") as file:
            file.write(SCENE.format(expect=expect, params=params, keys=keys))

    def stress(self, *arguments):
        return self.call("stress", *arguments)


def test_expectations_that_hold_and_not():
    with Cases() as box:
        box.case("falls", "{ momentum_drift = 1e-4, centre_y = { -0.0555, -0.045 }, determinant_min = 0.99 }")
        box.case("cannot", "{ momentum_drift = 1e-4, speed_max = 0.5 }")
        box.case("known", "{ speed_max = 0.5, known_limit = 'it falls: METHOD.md section 0' }")
        box.case("mended", "{ speed_max = 5, known_limit = 'it was so' }")
        box.case("stops", "{ stop = 'outside of the domain' }", keys="domain = { min = { -1, -0.12, -1 }, max = { 1, 1, 1 } },")
        box.case("goes_on", "{ stop = 'outside of the domain' }")
        box.case("unmeasured", "{ diffused_drift = 1 }")
        code, out, _ = box.stress("falls", "cannot", "known", "mended", "stops", "goes_on", "unmeasured", "--json")
        runs = {run["case"]: run for run in json.loads(out)["runs"]}
        check(code == 1, f"some fail: exit code {code}")
        verdicts = {name: run["verdict"] for name, run in runs.items()}
        check(verdicts == {"falls": "holds", "cannot": "FAILS", "known": "known limit", "mended": "FAILS", "stops": "stops", "goes_on": "FAILS", "unmeasured": "FAILS"},
              f"verdicts: {verdicts}")
        figure = next(f for f in runs["cannot"]["figures"] if f["measure"] == "speed_max")
        check(not figure["holds"] and figure["high"] == 0.5 and 0.9 < figure["value"] < 1.1, f"the figure that decided: {figure}")
        check(runs["cannot"]["text"].startswith("! speed_max"), f"what fails comes first: {runs['cannot']['text']}")
        check("ran to its end" in runs["goes_on"]["text"] and "was not measured" in runs["unmeasured"]["text"], "why they fail")
        tags = dict(box.rows("SELECT runs.id, tag FROM tags JOIN runs USING (run)"))
        check(tags[runs["falls"]["run_id"]] == "stress:falls", f"tagged: {tags}")
        events = dict(box.rows("SELECT id, text FROM events JOIN runs USING (run) WHERE kind = 'verdict'"))
        check(events[runs["cannot"]["run_id"]].startswith("FAILS: ! speed_max 1"), f"the verdict is kept: {events[runs['cannot']['run_id']]}")
        check(box.stress("falls", "stops", "known")[0] == 0, "all as expected: 0")
        code, out, _ = box.stress("--last", "falls", "known")
        check(code == 0 and "holds" in out and "known limit" in out and len(box.rows("SELECT run FROM runs")) == 10, f"the last verdicts, and nothing run: {out}")


def test_refused_before_a_run_begins():
    """It has no run, but a verdict that is kept until a run of it begins."""
    with Cases() as box:
        fits, misses = ("domain = {{ min = {{ {0}, {0}, {0} }}, max = {{ 1, 1, 1 }} }},".format(low) for low in (-1, 0))
        box.case("outside", "{ stop = 'outside' }", keys=misses)
        code, out, _ = box.stress("outside", "--json")
        run = json.loads(out)["runs"][0]
        check(code == 0 and run["verdict"] == "stops" and run["run_id"] is None, f"stops without a run: {run}")
        code, out, _ = box.stress("--last", "--json", "outside")
        last = json.loads(out)["runs"][0]
        check(code == 0 and last["verdict"] == "stops" and last["text"] == run["text"], f"its verdict is kept: {last}")
        check(box.stress("--last", "--precision", "f64", "outside")[1].startswith("1/1  not run"), "of that precision alone")
        check(box.stress("outside")[0] == 0 and box.rows("SELECT name, precision FROM refusals") == [("outside", "f32")], "the newest alone")
        box.case("outside", "{ speed_max = 5 }", keys=fits)
        box.stress("outside")
        check("  holds  " in box.stress("--last", "outside")[1] and not box.rows("SELECT 1 FROM refusals"), "a run takes its place")


def test_likeness():
    with Cases() as box:
        params = ", variant = s.choice { 'here', 'there', 'elsewhere' }"
        keys = "transfer = p.variant == 'elsewhere' and 'pic' or 'apic', "
        box.case("same", "p.variant ~= 'here' and { same_as = { variant = 'here', tolerance = 1e-12 } } or { speed_max = 2 }", params,
                 keys + "cfl = p.variant == 'elsewhere' and 0.4 or 0.5,")
        code, out, _ = box.stress("same/there", "--json")
        runs = {run["case"]: run for run in json.loads(out)["runs"]}
        check(code == 0 and set(runs) == {"same/here", "same/there"}, f"what it is compared with is run too: {set(runs)}")
        check(runs["same/there"]["difference"] == 0, "the same scene gives the same bits")
        code, out, _ = box.stress("same/elsewhere", "--json")
        runs = {run["case"]: run for run in json.loads(out)["runs"]}
        check(code == 1 and runs["same/elsewhere"]["difference"] > 0, "other steps give other places")


def test_wrong_words():
    with Cases() as box:
        box.case("falls", "{ speed_max = 5 }")
        code, _, err = box.stress("fals")
        check(code == 2 and "did you mean 'falls'" in err, f"a wrong case: {code} {err}")
        code, _, err = box.stress("--effect", "elastik")
        check(code == 2 and "did you mean 'elastic'" in err, f"a wrong effect: {code} {err}")
        check(box.stress("--precision", "f16")[0] == 2, "a wrong precision")
        box.case("falls", "{ sped_max = 5 }")
        code, _, err = box.stress("falls")
        check(code == 2 and "did you mean 'speed_max'" in err and "falls.lua:6" in err, f"a wrong measure: {code} {err}")
        box.case("falls", "{ speed_max = { 5, 1 } }")
        check(box.stress("falls")[0] == 2, "a range the wrong way round")
        box.case("falls", "nil")
        code, _, err = box.stress("falls")
        check(code == 2 and "expect" in err, f"a case without expectations: {code} {err}")
        code, out, err = box.stress("--measures", "--json")
        check(code == 2 and "--measures" in err and not out, f"a table for people asked for as JSON: {code}: {out[:80]}{err}")


def test_every_effect_has_a_case():
    with Cases() as box:
        code, out, err = box.stress("--list", "--json")
        listed = json.loads(out)
        check(code == 0, f"exit code {code}: {err}")
        check(all(effect["cases"] for effect in listed["coverage"]), f"without a case: {[e['effect'] for e in listed['coverage'] if not e['cases']]}")
        effects = subprocess.run([SUNDER, "help", "effects"], capture_output=True, text=True, check=True).stdout
        check(len(listed["coverage"]) == effects.count("\n## "), "as many as there are effects")
        markdown = box.stress("--list", "--markdown")[1]
        with open(os.path.join(SOURCE, "docs", "stress-cases.md"), encoding="utf-8") as file:
            check(file.read() == markdown, "docs/stress-cases.md is what `sunder stress --list --markdown` prints")


run_tests(globals())
