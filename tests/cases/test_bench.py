#!/usr/bin/env python3
"""The benchmark's contract: fields, cases, machine, and that the cracking cases crack. No test on time.

Usage: test_bench.py SUNDER
"""
import csv, json, os, subprocess, sys, tempfile

SUNDER = os.path.abspath(sys.argv[1])
failures, checks = [], 0


def check(condition, text):
    global checks
    checks += 1
    if not condition:
        failures.append(text)
        print("  failed:", text)


def call(*arguments):
    done = subprocess.run([SUNDER, "bench", *arguments], capture_output=True, text=True, timeout=600)
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


def test_wrong_arguments():
    for arguments, expected in ((["sheet", "--case", "elastic"], "belong to step"), ([], "expected"),
                                (["steps"], "expected step"), (["step", "--case", "elastc"], "elastic"),
                                (["step", "--precision", "f16"], "f32 or f64"), (["step", "--repeat", "0"], "whole number"),
                                (["step", "--seconds", "x"], "a number"), (["step", "--particles", "3"], "whole number")):
        code, out, err = call(*arguments)
        check(code == 2 and out == "" and expected in err, f"{arguments}: {code} {out} {err}")


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            before = len(failures)
            test()
            print("ok  " if len(failures) == before else "FAIL", name, flush=True)
    print(f"{checks} checks, {len(failures)} failed")
    sys.exit(1 if failures or not checks else 0)


main()
