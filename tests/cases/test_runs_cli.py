#!/usr/bin/env python3
"""What the ledger's commands do with past runs: runs best, query, sql, tag, note, rm, reproduce; plot, export, mesh; sweep --list.

Usage: test_runs_cli.py SUNDER [NAME...]   One ledger of a few small runs is made once; each test that changes it has its own.
"""
import csv, io, json, math, os, pty, shutil, struct, subprocess

import harness
from harness import SOURCE, SUNDER, check, run_tests

PULL = os.path.join(SOURCE, "scenes/solid/tube_pull.lua")
SMALL = ["--set", "particles=600", "--set", "break_stretch=0.02", "--set", "pull=0.6"]


class Box(harness.Box):
    def __enter__(self):
        super().__enter__()
        self.environment["COLUMNS"] = "200"
        return self

    def json(self, *arguments):
        code, out, err = self.call(*arguments, "--json")
        check(code == 0, f"{' '.join(arguments)}: exit code {code}: {err}")
        return json.loads(out) if out else {}

    def make(self, *arguments, frames="3"):
        code, out, err = self.call("run", PULL, *SMALL, "--frames", frames, "--threads", "1", *arguments, "--json", "--quiet")
        check(code == 0, f"a run: {err}")
        return json.loads(out)


def test_asking(box, runs):
    best = box.json("runs", "best", "kinetic", "--most", "--limit", "1")
    most = max(box.rows("SELECT id, value FROM final_measures WHERE name = 'kinetic'"), key=lambda row: row[1])
    check(best["rows"][0][0] == most[0] and len(best["rows"]) == 1, "best by a measure")
    code, _, err = box.call("runs", "best", "kinetik")
    check(code == 2 and "kinetic" in err, "a measure that is none: the nearest")
    names = [query["name"] for query in box.json("runs", "query")["queries"]]
    check({"best", "effect_of", "history"} <= set(names), "ready-made queries are listed")
    effect = box.json("runs", "query", "effect_of", "parameter=pull")
    check(len(effect["rows"]) == 1 and effect["rows"][0][2] == len(runs), "a ready-made query with a parameter")
    check([row[0] for row in box.json("runs", "query", "effect_of", "parameter=eta")["rows"]] == [0.1, 0.4], "by the end of a dotted name")
    check(box.json("runs", "query", "effect_of", "parameter=ta")["rows"] == [], "but not by the end of a word")
    code, out, _ = box.call("runs", "query", "effect_of", "help")
    check(code == 0 and ":parameter" in out, "what a query asks for")
    code, _, err = box.call("runs", "query", "effect_off")
    check(code == 2 and "effect_of" in err, "a query that is none")
    code, _, err = box.call("runs", "query", "effect_of", "paramter=pull")
    check(code == 2 and "parameter" in err, "a parameter that is none")
    answer = box.json("runs", "sql", "SELECT count(*) AS n FROM runs_view WHERE particles > :least", "least=10")
    check(answer == {"columns": ["n"], "rows": [[len(runs)]]}, f"one's own SQL: {answer}")
    for words in (["sql", "SELECT id FROM runs WHERE particles > :least"], ["query", "history", "measure=kinetic"], ["query", "effect_of"]):
        code, out, err = box.call("runs", *words)
        check(code == 2 and "=VALUE" in err and not out, f"{words}: what a query asks for and was not given: {code}: {err}{out}")
    code, _, err = box.call("runs", "sql", "DELETE FROM runs")
    check(code == 2 and len(box.rows("SELECT id FROM runs")) == len(runs), "SQL that writes is refused")
    for words in (["runs", "list"], ["plot", "last"], ["export", "last", "--format", "csv"], ["mesh", "last"], ["render", "last"]):
        code, out, err = box.call(*words, "--db", "none.db")
        check(code == 2 and "none.db" in err and not os.path.exists(box.path("none.db")), f"{words}: a ledger that is none is not made: {code}: {out}{err}")
    code, _, err = box.call("runs", "bets")
    check(code == 2 and "best" in err, "a verb that is none")


def test_remarks(box, runs):
    run = runs[0]["run_id"]
    check(box.json("runs", "tag", run, "paper", "figure 2") == {"run_id": run, "tags": ["figure 2", "paper"]}, "tags are added")
    check(box.json("runs", "tag", run[-6:], "paper", "--remove")["tags"] == ["figure 2"], "and taken away, by the end of an id")
    check(box.call("runs", "tag", run, "papre", "--remove")[0] == 2, "a tag that it does not have")
    check(box.json("runs", "note", run, "tears", "too late") == {"run_id": run, "note": "tears too late"}, "a note")
    check(box.rows("SELECT text FROM notes") == [("tears too late",)], "its words make one text")
    check(box.call("runs", "note", run)[0] == 2, "a note without a text")
    check(run in box.call("runs", "list", "--where", "tags = 'figure 2'")[1], "found by its tag")


def test_taking_away():
    with Box() as box:
        first, second = box.make(), box.make("--out", box.path("mine"))
        open(box.path("mine/picture.png"), "w").close()
        code, _, err = box.call("runs", "rm", first["run_id"])
        check(code == 2 and "--yes" in err and os.path.exists(first["out"]), "without a terminal and --yes nothing goes")
        answer = box.json("runs", "rm", first["run_id"], second["run_id"], "--yes")
        check([r["kept"] for r in answer["removed"]] == [0, 1], f"what stays is counted: {answer}")
        check(not os.path.exists(first["out"]) and os.listdir(box.path("mine")) == ["picture.png"], "files are gone, a stranger's stays")
        check(box.rows("SELECT count(*) FROM runs")[0][0] == 0 and box.rows("SELECT count(*) FROM run_measures")[0][0] == 0, "rows are gone")
        third = box.make()
        box.rows("UPDATE runs SET output = ?", box.folder)
        code, _, err = box.call("runs", "rm", third["run_id"], "--yes")
        check(code == 2 and os.path.exists(box.db) and os.path.exists(third["out"]), "a folder that is no run's is left alone")
        check(box.rows("SELECT count(*) FROM runs")[0][0] == 1, "and so is the row")
        check(box.call("runs", "rm", third["run_id"], "--yes", "--keep-files")[0] == 0 and os.path.exists(third["out"]), "the row alone")


def answer_on_a_terminal(box, arguments, text):
    """The exit code of a command that is asked on a terminal and given an answer."""
    master, slave = pty.openpty()
    process = subprocess.Popen([SUNDER, *arguments], env=box.environment, cwd=box.folder, stdin=slave, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    os.close(slave)
    os.write(master, text)
    _, err = process.communicate(timeout=60)
    os.close(master)
    return process.returncode, err


def test_asking_first():
    with Box() as box:
        run = box.make()
        code, err = answer_on_a_terminal(box, ["runs", "rm", "last"], b"n\n")
        check(code == 130 and "[y/N]" in err and os.path.exists(run["out"]), "no: nothing is removed")
        code, err = answer_on_a_terminal(box, ["runs", "rm", "last"], b"y\n")
        check(code == 0 and not os.path.exists(run["out"]), "yes: it is")


def test_reproducing():
    with Box() as box:
        run = box.make("--turn", "1:damage.eta=0.3")
        again = box.json("runs", "reproduce", run["run_id"], "--threads", "2")
        check(again["same"] and again["first_difference"] is None and again["frames"] == 3, f"the same bits, turns and threads included: {again}")
        check(json.load(open(os.path.join(again["out"], "result.json")))["state_hash"] == run["state_hash"], "the same state")
        # A frame whose bytes are another's: the comparison looks.
        shutil.copy(os.path.join(run["out"], "frames/000001.hdf"), os.path.join(run["out"], "frames/000002.hdf"))
        other = box.make("--set", "eta=0.9")
        shutil.copy(os.path.join(other["out"], "frames/000003.hdf"), os.path.join(run["out"], "frames/000003.hdf"))
        code, out, err = box.call("runs", "reproduce", run["run_id"], "--json")
        found = json.loads(out)
        check(code == 1 and not found["same"], f"other bits are told: {code} {err}")
        check(found["first_difference"]["frame"] == 2 and found["first_difference"]["largest"] > 0, f"where they begin: {found}")
        check(box.call("runs", "reproduce", "nobody")[0] == 2, "a run that is none")
        shutil.rmtree(other["out"])
        check(box.call("runs", "reproduce", other["run_id"])[0] == 2, "a run whose folder is gone")


def test_plots(box, runs):
    ids = [run["run_id"] for run in runs]
    code, out, err = box.call("plot", *ids, "--measure", "kinetic", "--width", "70", "--height", "12")
    lines = out.split("\n")
    check(code == 0 and lines[0] == "kinetic" and all(len(line) <= 70 for line in lines[1:13]), "a plot of the size asked for")
    check(any(0x2800 < ord(c) < 0x2900 for c in out) or "*" in out, "with curves")
    check(all(f"{chr(65 + i)}  {run}" in out for i, run in enumerate(ids)), "and a legend")
    answer = box.json("plot", ids[0], "--measure", "kinetic", "--measure", "damage_max")
    history = box.rows(f"SELECT time, value FROM measures_view WHERE id = '{ids[0]}' AND name = 'damage_max' ORDER BY frame")
    check([c["measure"] for c in answer["curves"]] == ["kinetic", "damage_max"], "a curve for each measure")
    check(list(zip(answer["curves"][1]["x"], answer["curves"][1]["y"])) == history, "numbers are the ledger's")
    answer = box.json("plot", "--where", "1", "--against", "eta", "--measure", "damage_max")
    expected = sorted(box.rows("SELECT p.number, m.value FROM run_parameters AS p JOIN final_measures AS m USING (run) WHERE p.name = 'tube.damage.eta' AND m.name = 'damage_max'"))
    check(list(zip(answer["curves"][0]["x"], answer["curves"][0]["y"])) == expected, f"a measure against a parameter: {answer}")
    ascii_only = dict(box.environment, LC_ALL="C")
    code, out, _ = box.call("plot", ids[0], environment=ascii_only)
    check(code == 0 and out.isascii(), "ASCII where the locale has nothing else")
    code, _, err = box.call("plot", ids[0], "--measure", "damage_mx")
    check(code == 2 and "damage_max" in err, "a measure that is none")
    check(box.call("plot", "--where", "0")[0] == 2 and box.call("plot")[0] == 2, "no run")
    code, _, _ = box.call("plot", *ids, "--measure", "kinetic", "--out", "figure.gp", "--log")
    script = open(box.path("figure.gp")).read()
    check(code == 0 and script.count("EOD\n") == 2 * len(ids) and "set logscale y" in script, "a script for gnuplot")
    check(box.call("plot", ids[0], "--out", "figure.jpg")[0] == 2, "a figure of another kind")
    without = dict(box.environment, PATH="/nonexistent")
    code, out, err = box.call("plot", ids[0], "--out", "figure.png", environment=without)
    check(code == 1 and "gnuplot-nox" in err and not os.path.exists(box.path("figure.png")) and "time" in out, "without gnuplot: said, and drawn here")
    if shutil.which("gnuplot"):
        check(box.call("plot", *ids, "--out", "figure.png")[0] == 0 and open(box.path("figure.png"), "rb").read(8) == b"\x89PNG\r\n\x1a\n", "a PNG by gnuplot")


def read_ply(path):
    """Names of elements with their counts and properties, and the vertices as tuples."""
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements, form = {}, "<"
    for line in data[:end].decode().split("\n"):
        words = line.split()
        if words[:1] == ["element"]:
            last = elements[words[1]] = {"count": int(words[2]), "properties": []}
        elif words[:1] == ["property"]:
            last["properties"].append(words[-1])
            form += {"float": "f", "int": "i"}.get(words[1], "") if "face" not in elements else ""
    vertices = [struct.unpack_from(form, data, end + i * struct.calcsize(form)) for i in range(elements["vertex"]["count"])]
    rest = data[end + struct.calcsize(form) * elements["vertex"]["count"]:]
    return elements, vertices, rest


def test_exports(box, runs):
    run, ident = runs[0], runs[0]["run_id"]
    table = list(csv.DictReader(io.StringIO(box.call("export", ident, "--format", "csv")[1])))
    kinetic = [value for (value,) in box.rows(f"SELECT value FROM measures_view WHERE id = '{ident}' AND name = 'kinetic' ORDER BY frame")]
    check([float(row["kinetic"]) for row in table] == kinetic and [row["frame"] for row in table] == ["0", "1", "2", "3"], "measures as CSV")
    check(json.loads(box.call("export", ident, "--format", "json")[1])["run_id"] == ident, "the run as JSON")
    answer = box.json("export", ident, "--format", "ply", "--out", "p.ply", "--all")
    check(answer["frames"] == 4 and os.path.exists(box.path("p.000000.ply")) and os.path.exists(box.path("p.000003.ply")), "a sequence of PLY")
    elements, vertices, rest = read_ply(box.path("p.000003.ply"))
    check(len(vertices) == run["particles"] and rest == b"" and {"damage", "velocity_x", "id", "body"} <= set(elements["vertex"]["properties"]), "PLY with fields")
    box.call("export", ident, "--format", "csv", "--frame", "3", "--out", "points.csv")
    points = list(csv.DictReader(open(box.path("points.csv"))))
    names = elements["vertex"]["properties"]
    check(len(points) == len(vertices) and all(float(points[5][n]) == vertices[5][i] or abs(float(points[5][n]) - vertices[5][i]) < 1e-6 * abs(vertices[5][i])
                                               for i, n in enumerate(names)), "PLY and CSV agree")
    box.call("export", ident, "--format", "obj", "--frame", "3", "--out", "points.obj")
    places = [tuple(map(float, line.split()[1:])) for line in open(box.path("points.obj")) if line.startswith("v ")]
    check(len(places) == len(vertices) and max(abs(a - b) for p, v in zip(places, vertices) for a, b in zip(p, v)) < 1e-6, "OBJ's points")
    check(box.call("export", ident, "--format", "vtp", "--all", "--out", "v.vtp")[0] == 0, "a sequence of VTP")
    series = open(box.path("v.pvd")).read()
    check(series.count("<DataSet") == 4 and 'timestep="0.125" part="0" file="v.000003.vtp"' in series, "with a PVD of its times")
    check(box.call("export", ident, "--format", "usda", "--out", "u.usda")[0] == 0, "USD")
    usd = open(box.path("u.usda")).read()
    check("timeCodesPerSecond = 24" in usd and "endTimeCode = 3" in usd and usd.count("        3: [") == usd.count(".timeSamples = {"), "with samples of all frames")
    check(usd.count("{") == usd.count("}") and usd.count("[") == usd.count("]") and 'interpolation = "vertex"' in usd, "well formed")
    check(box.call("export", ident, "--format", "ply", "--part", "sheet")[0] == 2 and box.call("export", ident, "--format", "ply", "--part", "solid")[0] == 0, "a part of it")
    check(box.call("export", ident, "--format", "plly")[0] == 2 and box.call("export", ident, "--format", "ply", "--out", "a.obj")[0] == 2, "wrong formats")
    check(box.call("export", ident, "--format", "ply", "--frame", "77")[0] == 2, "a frame that is none")


VTP_CHECK = """
import sys
from paraview.simple import PVDReader, GetAnimationScene
reader = PVDReader(FileName=sys.argv[1])
reader.UpdatePipelineInformation()
times = list(reader.TimestepValues)
reader.UpdatePipeline(times[-1])
data = reader.GetDataInformation()
array = reader.PointData.GetArray("damage")
print(len(times), data.GetNumberOfPoints(), array.GetRange()[1], reader.PointData.GetArray("velocity").GetNumberOfComponents())
"""


def test_paraview(box, runs):
    if not shutil.which("pvpython"):
        print("  no ParaView here")
        check(True, "")
        return
    box.call("export", runs[0]["run_id"], "--format", "vtp", "--all", "--out", "w.vtp")
    open(box.path("look.py"), "w").write(VTP_CHECK)
    out = subprocess.run(["pvpython", box.path("look.py"), box.path("w.pvd")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
    words = out.stdout.split()
    check(words[:2] == ["4", str(runs[0]["particles"])] and words[3] == "3", f"ParaView opens the sequence: {out.stdout} {out.stderr[-300:]}")
    check(abs(float(words[2]) - runs[0]["damage"]["max"]) < 1e-6, "with the damage that the run told")


def is_closed(triangles):
    edges = {}
    for a, b, c in triangles:
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] = edges.get(edge, 0) + 1
    return all(edges.get((b, a), 0) == n for (a, b), n in edges.items())


def test_meshes(box, runs):
    ident = runs[0]["run_id"]
    answer = box.json("mesh", ident, "--frame", "0", "--out", "body.obj")
    lines = open(box.path("body.obj")).read().split("\n")
    vertices = [tuple(map(float, line.split()[1:])) for line in lines if line.startswith("v ")]
    triangles = [tuple(int(word) - 1 for word in line.split()[1:]) for line in lines if line.startswith("f ")]
    check(len(vertices) == answer["vertices"] and len(triangles) == answer["triangles"] > 100, "an OBJ")
    check(is_closed(triangles), "without holes")
    volume = sum(v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) + v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) + v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0])
                 for v in ([vertices[i] for i in t] for t in triangles)) / 6
    exact = 2 * math.pi * (0.30 ** 2 - 0.12 ** 2)
    check(abs(volume - exact) < 0.15 * exact, f"as large as the tube: {volume} for {exact}")
    box.call("mesh", ident, "--frame", "0", "--out", "body.stl")
    check(os.path.getsize(box.path("body.stl")) == 84 + 50 * len(triangles), "an STL of as many triangles")
    box.json("mesh", ident, "--all", "--field", "damage", "--out", "body.ply")
    elements, _, rest = read_ply(box.path("body.000003.ply"))
    check(elements["vertex"]["properties"][3:] == ["damage"] and len(rest) == 13 * elements["face"]["count"] > 0, "a sequence of PLY with the damage")
    whole, intact = box.json("mesh", ident, "--out", "w.ply"), box.json("mesh", ident, "--intact", "--out", "i.ply")
    check(whole["triangles"] != intact["triangles"], "broken particles are left out")
    check(box.call("mesh", ident, "--field", "damge")[0] == 2 and box.call("mesh", ident, "--cell", "-1")[0] == 2 and box.call("mesh", ident, "--out", "a.vtk")[0] == 2, "wrong wishes")
    code, _, err = box.call("mesh", ident, "--cell", "100", "--out", "none.ply")
    check(code == 2 and "--cell" in err and not os.path.exists(box.path("none.ply")), f"cells larger than the body: {code}: {err}")
    code, _, err = box.call("mesh", ident, "--field", "damage", "--out", "none.stl")
    check(code == 2 and "--field" in err and not os.path.exists(box.path("none.stl")), f"a quantity for a format without: {code}: {err}")


SWEEP = """local s = require "sunder"
return s.sweep { title = "Little", scene = "%s", frames = 1, set = { particles = 600 }, over = { eta = { 0.1, 0.2 }, break_stretch = { 0.1, 0.3 } } }
"""


def test_sweep_list():
    with Box() as box:
        open(box.path("little.lua"), "w").write(SWEEP % PULL)
        code, out, err = box.call("sweep", "little.lua", "--list")
        check(code == 0 and out.count("not started") == 4 and box.rows("SELECT count(*) FROM runs")[0][0] == 0, f"nothing is done: {out}{err}")
        code, out, _ = box.call("sweep", "little.lua", "--lines", "--threads", "1", "--set", "gamma=5")
        check(code == 0 and [line.split("\t")[2] for line in out.splitlines()] == 4 * ["going", "done"], f"a line for each start and end: {out}")
        ids = sorted(line.split("\t")[3] for line in out.splitlines() if "\tdone\t" in line)
        check(ids == sorted(ident for ident, in box.rows("SELECT id FROM runs_view")), f"with the runs' ids: {out}")
        code, out, err = box.call("sweep", "little.lua", "--threads", "1")
        check(code == 0 and out.count("/4  done ") == 4, f"and for people one an end: {code} {out}{err}")
        check(box.call("sweep", "little.lua", "--list")[1].count("  done before  ") == 4, "all is done")


with Box() as shared:
    made = [shared.make("--set", f"eta={eta}") for eta in (0.1, 0.4)]
    run_tests(globals(), shared, made)
