#!/usr/bin/env python3
"""The benchmark's contract: fields, cases, machine, and that the cracking cases crack. No test on time.

Usage: test_bench.py SUNDER [NAME...]
"""
import csv, json, math, os, signal, subprocess, tempfile, time

from harness import SOURCE, SUNDER, check, run_tests

SCENES = os.path.join(SOURCE, "scenes")


def call(*arguments, path=None):
    environment = {**os.environ, "PATH": path} if path is not None else None
    done = subprocess.run([SUNDER, "bench", *arguments], capture_output=True, text=True, timeout=600, env=environment)
    return done.returncode, done.stdout, done.stderr


def test_contract():
    with tempfile.TemporaryDirectory() as folder:
        table = os.path.join(folder, "rows.csv")
        code, out, err = call("step", "--json", "--csv", table, "--particles", "3000", "--seconds", "0", "--repeat", "1")
        check(code == 0, f"exit code {code}: {err}")
        result = json.loads(out)
        with open(table) as lines:
            check(len(list(csv.DictReader(lines))) == len(result["rows"]), "one line a row in the CSV")
    check({"triad_gb_s", "fma_gflop_s", "fma_gflop_s_f64", "processor", "cache_bytes"} <= set(result["machine"]), "machine")
    check(result["machine"]["triad_gb_s"] > 0 and result["machine"]["fma_gflop_s"] > 0, "machine's figures")
    check([(s["threads"], s["rounds"] > 0, 2500 < s["particles"] < 3500) for s in result["scaling"]] == [(2, True, True)], f"scaling: {result['scaling']}")
    check(all(0 < s[key] < math.inf for s in result["scaling"] for key in ("ratio", "independent_copies_ratio")), f"scaling: {result['scaling']}")
    rows = result["rows"]
    check({r["case"] for r in rows} >= {"elastic", "fibres", "damage", "damage_early", "implicit"}, "cases")
    check({(r["precision"], r["threads"]) for r in rows} == {(p, t) for p in ("f32", "f64") for t in (1, 2)}, "precisions and threads")
    check({r["laplacian"] for r in rows if r["case"] == "damage"} == {"quadratic", "cubic"}, "both Laplacians")
    for row in rows:
        name = f"{row['case']} {row['precision']} on {row['threads']}"
        for key in ("case engine precision kernel laplacian threads particles bonds particle_steps_per_s bond_steps_per_s "
                    "ns_per_particle bytes_per_particle phases roofline_fraction").split():
            check(key in row, f"{name}: '{key}'")
        check(row["engine"] == "solid" and row["bonds"] == 0 and row["kernel"] == "quadratic", f"{name}: {row}")
        check(2500 < row["particles"] < 3500, f"{name}: {row['particles']} particles")
        check(abs(row["ns_per_particle"] * row["particle_steps_per_s"] - 1e9) < 1, f"{name}: time and rate agree")
        check(abs(sum(row["phases"].values()) - row["ns_per_particle"]) < 1e-6 * row["ns_per_particle"], f"{name}: phases sum to the time")
        check(all(row["phases"][phase] > 0 for phase in ("sort", "p2g", "grid", "g2p", "measure")), f"{name}: {row['phases']}")
        check(row["roofline_fraction"] > 0 and row["bytes_moved_per_particle"] > 0, f"{name}: roofline")
        check(row["bytes_per_particle"] > (100 if row["precision"] == "f32" else 200), f"{name}: bytes")


def test_cracking_and_early_outs():
    code, out, err = call("step", "--json", "--case", "damage", "--case", "damage_early", "--case", "implicit", "--case", "elastic", "--particles",
                          "6000", "--threads", "1", "--seconds", "0", "--repeat", "1")
    check(code == 0, f"exit code {code}: {err}")
    for row in json.loads(out)["rows"]:
        above, evaluated = row["above_critical"], row["evaluated"]
        name = f"{row['case']} {row['precision']} {row['laplacian']}: {above}, {evaluated}"
        if row["case"] == "elastic":
            check(above is None and evaluated is None, name)
        elif row["case"] == "damage_early":
            check(above == 0 and evaluated == 0, name)
        else:
            check(above >= 0.02, name)
        if row["case"] == "damage":
            check(evaluated >= 0.9, f"hardly any particle is passed over: {name}")


def test_narrowing():
    code, out, err = call("step", "--case", "elastic", "--particles", "2000", "--threads", "1", "--precision", "f64", "--seconds", "0")
    check(code == 0 and out.count("elastic") == 1 and "f64" in out and err == "", f"one row for people: {code} {out} {err}")


def test_sheet():
    code, out, err = call("sheet", "--json", "--particles", "2500", "--threads", "1", "--precision", "f32", "--seconds", "0")
    check(code == 0, f"sheet: {err}")
    data = json.loads(out)
    check(data["machine"]["triad_gb_s"] > 0 and data["machine"]["fma_gflop_s"] > 0, "sheet: the machine")
    check([(r["case"], r["neighbours"]) for r in data["rows"]] == [("linear", 8), ("tearing", 8), ("linear", 28), ("tearing", 28)], "sheet: cases")
    for row in data["rows"]:
        # bonds are counted from both ends; edges have fewer
        check(row["engine"] == "sheet" and row["particles"] == 2500 and 0.85 * row["neighbours"] < row["bonds"] / 2500 < row["neighbours"], f"sheet: {row}")
        rate = row["bonds"] * 1e9 / (row["ns_per_particle"] * row["particles"])
        check(abs(row["bond_steps_per_s"] / rate - 1) < 1e-6, "sheet: rates agree")


# Stands for LAMMPS: it says what it would say if the sheet that it is given is the one that was asked for.
LAMMPS = """#!/bin/sh
[ "$1 $3 $4" = "-in -log none" ] || exit 1
echo "LAMMPS (1 Jan 2000)"
grep -q "^pair_style peri/pmb" "$2" && grep -q "^lattice sc 0.02" "$2" || { echo "ERROR: another sheet"; exit 1; }
bonds=$(grep -q "^pair_coeff [*] [*] 1 0.0302" "$2" && echo 19404 || echo 65664)
echo "  total # of bonds = $bonds"
echo "Loop time of 9.9 on 1 procs for 10 steps with 2500 atoms"
echo "Loop time of 0.5 on 1 procs for $(sed -n 's/^run //p' "$2" | tail -n 1) steps with 2500 atoms"
"""


def test_sheet_against_lammps():
    asked = ("sheet", "--against", "lammps", "--json", "--particles", "2500", "--threads", "1", "--precision", "f64", "--seconds", "0.01", "--repeat", "1")
    with tempfile.TemporaryDirectory() as folder:
        code, out, err = call(*asked, path=folder)
        check(code == 2 and out == "" and "lmp" in err and "package lammps" in err, f"without LAMMPS: {code} {err}")
        program = os.path.join(folder, "lmp_serial")
        with open(program, "w") as file:
            file.write(LAMMPS)
        os.chmod(program, 0o755)
        code, out, err = call(*asked, path=folder + ":" + os.environ["PATH"])
        check(code == 0, f"against LAMMPS: {err}")
        rows = json.loads(out)["against"] if code == 0 else []
        check([(r["neighbours"], r["bonds"], r["particles"]) for r in rows] == [(8, 19404, 2500), (28, 65664, 2500)], f"against LAMMPS: {rows}")
        for row in rows:
            check(abs(row["bond_steps_per_s"] / (row["bonds"] * row["steps"] / 0.5) - 1) < 1e-9 and row["program"] == "LAMMPS (1 Jan 2000)", f"against LAMMPS: {row}")
        with open(program, "w") as file:
            file.write("#!/bin/sh\necho 'ERROR: Unknown pair style peri/pmb'\n")
        code, out, err = call(*asked, path=folder + ":" + os.environ["PATH"])
        check(code != 0 and "Unknown pair style" in err, f"LAMMPS without peridynamics: {code} {err}")


# Both papers' first tables, copied from the papers once more: particles, seconds (a frame; of sheets 20 steps), step, frames a second.
PAPER = {
    "meat": (500e3, 19.30, 5e-4, 24), "tube_pull": (50e3, 1.403, 1e-3, 24), "tube_compress": (400e3, 83.36, 1e-4, 24),
    "pork_belly": (500e3, 38.78, 2.5e-4, 24), "orange": (80e3, 4.890, 1e-3, 24), "fish": (50e3, 0.5625, 1e-3, 48),
    "cheese": (500e3, 48.87, 2e-4, 24), "lance": (650e3, 111.9, 1.25e-4, 24),
    "lance_inextensible": (650e3, 111.9, 1.25e-4, 24), "heart": (500e3, 23.88, 5.1e-4, 24),
    "bone": (200e3, 1974, 1e-6, 48),
    "stretch": (10e3, 0.2, 1e-4, None), "shear": (10e3, 0.2, 1e-4, None), "crack_path": (10e3, 0.2, 1e-4, None),
    "foil": (2.5e3, 0.6, 3e-4, None), "rubber": (2.5e3, 0.2, 5e-4, None), "seaweed": (2.5e3, 0.2, 1e-4, None),
}


def table1(*arguments, scenes=SCENES, expected=0):
    """The rows of a run by name, and what people were told; nothing may be left in the folder for temporary files."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([SUNDER, "bench", "table1", "--json", "--scenes", scenes, *arguments], capture_output=True, text=True, timeout=600,
                              env={**os.environ, "TMPDIR": folder})
        check(os.listdir(folder) == [], f"{arguments}: left behind {os.listdir(folder)}")
    check(done.returncode == expected, f"{arguments}: exit code {done.returncode}: {done.stderr}")
    return {row["name"]: row for row in json.loads(done.stdout)["rows"]}, done.stderr


def test_table1_figures_and_missing_scenes():
    with tempfile.TemporaryDirectory() as empty:
        rows, told = table1("--paper", "both", scenes=empty)
        check(list(rows) == list(PAPER), f"all rows, in the papers' order: {list(rows)}")
        check(told.count("no scene yet") == len(PAPER), "each missing scene is said")
        check(set(table1("--paper", "sheet", scenes=empty)[0]) == {n for n in PAPER if not PAPER[n][3]}, "--paper sheet")
        check(set(table1(scenes=empty)[0]) == {n for n in PAPER if PAPER[n][3]}, "--paper solid is the default")
    for name, (particles, seconds, dt, fps) in PAPER.items():
        row = rows[name]
        check(row["status"] == "no scene yet" and "s_per_frame" not in row, f"{name}: {row}")
        check((row["paper_particles"], row["paper_dt"]) == (particles, dt), f"{name}: {row}")
        check(row["paper_s_per_frame" if fps else "paper_s_per_20_steps"] == seconds, f"{name}: {row}")
        check(os.path.exists(os.path.join(SCENES, os.path.relpath(row["scene"], empty))), f"{name}: {row['scene']} is not ours")
        if fps:
            check(f"fps={fps}" in row["settings"] and f"particles={particles:.0f}" in row["settings"], f"{name}: {row['settings']}")


def test_table1_row():
    rows, told = table1("--row", "tube_pull", "--scale", "0.04", "--frames", "2", "--warm", "1", "--threads", "1")
    row = rows["tube_pull"]
    for key in "name scene particles paper_s_per_frame s_per_frame ratio threads steps_per_frame dt".split():
        check(key in row, f"'{key}'")
    check(row["status"] == "timed" and row["threads"] == 1 and (row["warm"], row["frames"]) == (1, 2), f"{row}")
    check(1600 < row["particles"] < 2400 and row["scale"] == 0.04 and "0.04 times the paper's" in told, "the reduction shows")
    check(row["ratio"] is None, "no ratio where particle counts differ")
    check(abs(row["steps_per_frame"] * row["dt"] * 24 - 1) < 1e-6, f"steps fill a frame: {row}")
    check(0 < row["s_per_frame"] < row["run_s_per_frame"], f"a run does more than steps: {row}")
    rate = row["particles"] * row["steps_per_frame"] / row["s_per_frame"]
    check(abs(row["particle_steps_per_s"] / rate - 1) < 0.5, f"rate: {row}")


def test_table1_sheet_at_the_papers_count():
    row = table1("--row", "rubber", "--frames", "1", "--warm", "0", "--threads", "1")[0]["rubber"]
    check(2400 < row["particles"] < 2600, f"{row['particles']} particles")
    check(abs(row["s_per_20_steps"] * row["steps_per_frame"] / (20 * row["s_per_frame"]) - 1) < 1e-9, f"{row}")
    check(abs(row["ratio"] * row["s_per_20_steps"] / 0.2 - 1) < 1e-9, f"ratio is the paper's seconds over ours: {row}")


def test_table1_papers_step():
    row = table1("--row", "tube_pull", "--scale", "0.04", "--frames", "1", "--warm", "0", "--threads", "1", "--paper-dt")[0]["tube_pull"]
    check(row["dt_from"] == "paper" and "dt=0.001" in row["settings"], f"{row}")
    check(row["steps_per_frame"] == row["paper_steps_per_frame"] == math.ceil(1000 / 24), f"{row}")


def test_table1_papers_step_over_the_limit():
    # A tenth of the particles' distance: a tenth of the step.
    row = table1("--row", "seaweed", "--scale", "100", "--threads", "1", "--paper-dt", "--time-limit", "1")[0]["seaweed"]
    check(row["dt_from"] == "auto" and not any(s.startswith("dt=") for s in row["settings"]), f"{row}")
    check("over the limit" in row["note"] and "'linear'" in row["note"] and row["dt"] < 1e-4, f"{row}")


def test_table1_time_limit():
    row = table1("--row", "bone", "--scale", "0.2", "--time-limit", "1", "--threads", "1")[0]["bone"]
    check(row["status"] == "extrapolated" and row["extrapolated"] and row["frames"] == 0 and "extrapolated" in row["note"], f"{row}")
    check(abs(row["steps_per_frame"] * row["dt"] * 48 - 1) < 1e-6, f"steps fill a frame: {row}")
    check(row["s_per_frame"] > 1 and row["run_s_per_frame"] is None, f"longer than the limit: {row}")


def test_table1_failing_row_does_not_stop_the_others():
    with tempfile.TemporaryDirectory() as scenes:
        os.makedirs(os.path.join(scenes, "solid"))
        with open(os.path.join(scenes, "solid", "meat.lua"), "w") as scene:
            scene.write("return 1\n")
        with open(os.path.join(scenes, "solid", "tube_pull.lua"), "w") as scene:
            scene.write(open(os.path.join(SCENES, "solid", "tube_pull.lua")).read())
        os.symlink(os.path.join(SOURCE, "recipes"), os.path.join(scenes, "recipes"))
        rows, told = table1("--row", "meat", "--row", "tube_pull", "--scale", "0.02", "--frames", "1", "--warm", "0", scenes=scenes, expected=2)
    check(rows["meat"]["status"] == "failed" and "meat.lua" in rows["meat"]["note"], f"{rows['meat']}")
    check(rows["tube_pull"]["status"] == "timed", f"{rows['tube_pull']}")


def test_table1_interrupted():
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.Popen([SUNDER, "bench", "table1", "--scenes", SCENES, "--row", "bone", "--row", "meat", "--scale", "0.2"],
                               stdout=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": folder})
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not any("000000.hdf" in names for _, _, names in os.walk(folder)):
            time.sleep(0.05)
        run.send_signal(signal.SIGINT)
        out = run.communicate(timeout=60)[0]
        check(run.returncode == 130 and "interrupted" in out and "meat.lua" not in out, f"{run.returncode}: {out}")
        check(os.listdir(folder) == [], f"left behind {os.listdir(folder)}")


def test_constraint():
    code, out, err = call("constraint", "--json", "--scene", "hanging_torus", "--particles", "300", "--warm", "0", "--scenes", SCENES)
    check(code == 0, f"exit code {code}: {err}")
    rows = json.loads(out)["rows"]
    check({"auto", "jacobi"} <= {row["solver"] for row in rows} and {row["warm_start"] for row in rows} == {True, False}, f"every way: {rows}")
    check(all(row["solves"] >= row["steps"] > 0 and row["iterations_per_solve"] > 0 for row in rows), f"each step solves: {rows}")
    check(call("constraint", "--scene", "torus")[0] == 2, "a scene that is none of them")


def test_constitutive():
    code, out, err = call("constitutive", "--json", "--count", "10000")
    check(code == 0, f"exit code {code}: {err}")
    result = json.loads(out)
    rows = result["rows"]
    check({(r["precision"], r["model"]) for r in rows} == {(p, m) for p in ("f32", "f64") for m in ("closed form", "QR form", "fixed-corotated")}, "models")
    check(all(r["count"] >= 10000 and r["ns"] > 0 for r in rows), f"as many as asked for: {rows}")
    builds = [r for r in rows if r["build"] != "scalar"]
    check(len(builds) == 8 and all(r["difference"] < (1e-3 if r["precision"] == "f32" else 1e-9) for r in builds), f"builds agree: {builds}")
    qr = [r for r in rows if r["model"] == "QR form"]
    check(all(r["difference"] < (1e-3 if r["precision"] == "f32" else 1e-9) for r in qr), f"the paper's form is the closed form: {qr}")
    for precision in ("f32", "f64"):
        ns = {(r["build"], r["model"]): r["ns"] for r in rows if r["precision"] == precision}
        expected = ns["scalar", "fixed-corotated"] / ns["scalar", "QR form"]
        check(abs(result["ratios"][precision]["corotated_over_qr_scalar"] / expected - 1) < 1e-6, "the ratio is that of the rows")
    check(call("constitutive", "--count", "0")[0] == 2 and call("constitutive", "elastic")[0] == 2, "wrong arguments")


def test_table1_wrong_arguments():
    for arguments, expected in ((["--row", "tube_pul"], "did you mean tube_pull"), (["--paper", "solids"], "solid, sheet or both"),
                                (["--scale", "0"], "a number"), (["--frames", "0"], "whole number"), (["tube_pull"], "--row"),
                                (["--time-limit", "x"], "a number"), (["--frames", "500", "--warm", "20"], "together"),
                                (["--scenes", "/nowhere"], "--scenes")):
        code, out, err = call("table1", *arguments)
        check(code == 2 and out == "" and expected in err.replace("'", ""), f"{arguments}: {code} {out} {err}")


def test_wrong_arguments():
    for arguments, expected in ((["sheet", "--case", "elastic"], "belong to step"), ([], "expected"),
                                (["steps"], "expected step"), (["sheet", "--against", "other"], "expected lammps"), (["step", "--against", "lammps"], "belongs to sheet"), (["--json", "table1"], "as its first argument"), (["step", "--case", "elastc"], "elastic"),
                                (["step", "--precision", "f16"], "f32 or f64"), (["step", "--repeat", "0"], "whole number"),
                                (["step", "--seconds", "x"], "a number"), (["step", "--particles", "3"], "whole number")):
        code, out, err = call(*arguments)
        check(code == 2 and out == "" and expected in err, f"{arguments}: {code} {out} {err}")


run_tests(globals())
