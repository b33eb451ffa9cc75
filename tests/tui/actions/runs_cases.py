"""The Runs and Sweep screens over a ledger of three small runs that differ in eta: what a user sees, what the ledger keeps, what is on disk."""
import os
import re
import subprocess

import bench
from bench import check, covers

ETAS = ("0.1", "0.2", "0.4")


SWEEP = """return require("sunder").sweep {{
  title = "Little", scene = "{scenes}/solid/tube_pull.lua", frames = 1, set = {{ particles = 600 }},
  over = {{ break_stretch = {{ 0.02, 0.3 }}, eta = {{ 0.1, 0.2, 0.4 }}, pull = {{ 0.6, 0.8 }} }},
}}
"""


def call(s, *arguments):
    done = subprocess.run([bench.SUNDER, *arguments, "--db", s.ledger], cwd=s.folder, env=dict(os.environ, XDG_DATA_HOME=s.folder), capture_output=True, text=True,
                          check=False, timeout=300)
    check(done.returncode == 0, f"{arguments}: {done.stderr}")
    return done.stdout


def runs(s):
    """Makes the runs and brings their table into view; gives their ids, the oldest first."""
    for eta in ETAS:
        call(s, "run", f"{bench.SCENES}/solid/tube_pull.lua", "--set", "particles=600", "--set", "break_stretch=0.02", "--set", "pull=0.6", "--set", f"eta={eta}",
             "--frames", "4", "--threads", "1", "--quiet", "--out", f"{s.folder}/run-{eta}")
    s.wait(r"\[Scenes\]")
    s.do("screen runs")
    s.wait(r"3 of 3 runs")
    return [row[0] for row in s.sql("SELECT id FROM runs ORDER BY run")]


def order(s):
    """Ids in the order of the table."""
    return re.findall(r"^ ..(\d{8}-\d{6}-[0-9a-f]{4})", s.text(), re.M)


@covers("runs.filter", "runs.all", "runs.sort", "runs.columns", "runs.drop-column", "runs.left", "runs.right", "runs.up", "runs.down", "runs.page-up", "runs.page-down", start=None, width=200)
def table_is_filtered_and_sorted(s):
    ids = runs(s)
    check(order(s) == ids[::-1], f"the newest first: {order(s)}")
    s.do("runs.columns eta damage_max")
    s.do("runs.sort eta")
    s.until("by eta", lambda: order(s) == ids)
    s.wait(r" eta ▲")
    s.do("runs.sort -eta")
    s.until("the other way round", lambda: order(s) == ids[::-1])
    s.keys("/")
    s.type("eta<0.3 done tube")
    s.keys("Enter")
    s.wait(r"2 of 3 runs +that fit eta<0.3 done tube|2 of 3 runs")
    s.until("those that fit", lambda: order(s) == [ids[1], ids[0]])
    s.do("runs.filter etaa<1")
    s.wait(r"did\s+you\s+mean\s+'eta'")
    s.do("runs.filter nowhere")
    s.wait(r"No run fits")
    s.keys("A")
    s.wait(r"3 of 3 runs")
    s.do("runs.columns tags")  # taken away
    s.wait(r"^ +id .*tags", absent=True)
    for _ in range(12):
        s.keys("Left")
    s.keys("s")
    s.wait(r"id ▲")
    s.keys("s")
    s.wait(r"id ▼")
    s.keys("Right", "x")
    s.wait(r"^ +id .*status", absent=True)
    for key, row in (("NPage", 2), ("PPage", 0), ("Down", 1), ("Down", 2), ("Up", 1)):
        s.keys(key)
        s.do("runs.mark")
        s.wait(rf"^ ● {order(s)[row]}")
        s.do("runs.unmark")
        s.wait(r"●", absent=True)
        if row < 2:
            s.keys("Up")  # marking goes on to the next


@covers("runs.mark", "runs.unmark", "runs.diff", "runs.detail", "runs.beside", start=None)
def marked_runs_are_compared(s):
    runs(s)
    s.keys("d")
    s.wait(r"Mark two runs")
    s.keys("Space", "Space")
    s.wait(r"2 marked")
    s.keys("d")
    s.wait(r"What differs between 2 runs")
    line = s.wait(r"^ +\S*eta +(\S+) +(\S+)$")
    check({line.group(1), line.group(2)} == {"0.4", "0.2"}, f"their values: {line.group(0)}")
    check(not re.search(r"^ +\S*pull ", s.text(), re.M), "what is the same is not there")
    s.keys("BSpace")
    s.wait(r"3 of 3 runs")
    s.keys("b")
    s.wait(r"\[Compare\]")
    s.wait(r"frame \d .*frame \d")
    s.do("screen runs")
    s.wait(r"2 marked")
    s.keys("u")
    s.wait(r"marked", absent=True)
    s.keys("b")
    s.wait(r"Mark two runs")
    s.keys("<", "i")
    s.wait(r"^ +\S*pull +0\.6")
    s.keys(">")
    s.wait(r"first_crack|speed_max")
    s.keys("Escape")
    s.wait(r"3 of 3 runs")


@covers("runs.plot", "runs.measure", "runs.against", "runs.logarithmic", start=None, width=120, height=40)
def curves_are_drawn(s):
    ids = runs(s)
    s.keys("Space", "Space", "Space", "p")
    s.wait(r"broken_fraction over time")
    for letter, run in zip("ABC", ids[::-1]):
        s.wait(rf"{letter}  {run}")
    s.do("runs.plot kinetic")
    s.wait(r"kinetic over time")
    check(any(0x2800 < ord(c) < 0x2900 for c in s.text()), "braille curves")
    before = s.text()
    s.keys("n")
    s.until("logarithmic", lambda: s.text() != before)
    s.keys("m")
    s.wait(r"^ *(?!kinetic)\w+ over time")
    s.do("runs.against eta")
    s.wait(r"of the last frame against tube.damage.eta \(3 runs\)")
    s.do("runs.against variant")
    s.wait(r"a column of numbers")
    s.do("runs.against time")
    s.wait(r"over time")
    s.do("runs.plot kinettic")
    s.wait(r"did\s+you\s+mean\s+'kinetic'")


@covers("runs.choose", start=None)
def the_cursor_goes_to_a_run(s):
    ids = runs(s)
    s.do(f"runs.choose {ids[0]}")
    s.do("runs.tag oldest")
    s.until("its tag", lambda: s.sql("SELECT id FROM tags JOIN runs USING (run)") == [[ids[0]]])
    s.do("runs.filter eta>0.3")
    s.wait(r"1 of 3 runs")
    s.do(f"runs.choose {ids[0]}")
    s.wait(r"not among the runs")
    # What acts on the row under the cursor is in the log with the row.
    s.do(f"save-commands {s.folder}/all.log")
    s.until("the log", lambda: os.path.exists(f"{s.folder}/all.log"))
    with open(f"{s.folder}/all.log", encoding="utf-8") as file:
        lines = file.read().splitlines()
    tagged = lines.index("- runs.tag oldest")
    check(lines[tagged - 1] == f"- runs.choose {ids[0]}", f"the log: {lines}")


@covers("runs.tag", "runs.note", start=None)
def remarks_go_to_the_ledger(s):
    ids = runs(s)
    s.keys("Space", "Space", "T")
    s.type("paper")
    s.keys("Enter")
    s.until("two tags", lambda: s.sql("SELECT count(*) FROM tags WHERE tag = 'paper'") == [[2]])
    s.do("runs.unmark")
    s.keys("<")
    s.do("runs.tag -paper")
    s.until("one is taken away", lambda: s.sql("SELECT count(*) FROM tags") == [[1]])
    s.keys("N")
    s.type("tears too late")
    s.keys("Enter")
    s.until("a note", lambda: s.sql(f"SELECT text FROM notes JOIN runs USING (run) WHERE id = '{ids[2]}'") == [["tears too late"]])
    s.do("runs.filter late")
    s.wait(r"1 of 3 runs")
    # What others write is seen without asking.
    call(s, "runs", "tag", ids[2], "elsewhere")
    s.do("runs.all")
    s.do("runs.columns message effects")
    s.wait(r"elsewhere")


@covers("runs.open", "runs.frame", "runs.colour", "runs.turn-left", "runs.turn-right", "runs.tilt-up", "runs.tilt-down", "runs.zoom-in", "runs.zoom-out", "runs.reset", start=None, width=100, height=30)
def frames_are_played(s):
    runs(s)
    s.keys("Enter")
    s.wait(r"frame 0 of 4 .*damage")
    s.keys("Right")
    s.wait(r"frame 1 of 4")
    s.keys(">")
    s.wait(r"frame 4 of 4 +t = 0\.1667")
    s.keys("Right", "Left")
    s.wait(r"frame 3 of 4")
    s.do("runs.frame 2")
    s.wait(r"frame 2 of 4")
    check(any(0x2800 < ord(c) < 0x2900 for c in s.text()), "particles")
    for key in ("h", "l", "k", "j", "+", "-", "k", "0"):
        s.changes(key)
    s.keys("w")
    s.wait(r"frame 2 of 4.*(speed|body|stretch)")
    s.do("runs.colour fibre_stretch")
    s.wait(r"frame 2 of 4.*fibre_stretch")
    s.do("runs.colour fibre_strech")
    s.wait(r"did\s+you\s+mean\s+'fibre_stretch'")
    s.keys("<", "Space")
    s.wait(r"frame 4 of 4")
    s.wait(r"playing", absent=True)
    s.keys("BSpace")
    s.wait(r"3 of 3 runs")


@covers("runs.delete", "runs.delete-now", start=None)
def deleting_asks_and_takes_only_the_run(s):
    ids = runs(s)
    open(f"{s.folder}/run-0.4/mine.txt", "w", encoding="utf-8").close()
    s.keys("D")
    s.wait(r"away for good")
    s.keys("n")
    s.wait(r"away for good", absent=True)
    check(len(s.sql("SELECT id FROM runs")) == 3, "no is no")
    s.keys("D")
    s.wait(r"away for good")
    s.keys("y")
    s.wait(r"2 of 2 runs")
    check(os.listdir(f"{s.folder}/run-0.4") == ["mine.txt"] and os.path.exists(f"{s.folder}/run-0.2/result.json"), "its files are gone, and no others")
    s.do(f"runs.delete-now {ids[0]}")
    s.wait(r"1 of 1 runs")
    check(not os.path.exists(f"{s.folder}/run-0.1"), "a folder with nothing else in it goes as well")


@covers("runs.reproduce", start=None, width=120, height=30)
def a_run_is_made_again_with_the_same_bits(s):
    runs(s)
    s.keys("R")
    s.wait(r"the same bits at frame 4", patience=60)
    check(len(s.sql("SELECT id FROM runs")) == 4, "as a run of its own")


@covers("runs.home", "runs.end", start=None, width=40, height=10)
def small_and_large(s):
    runs(s)
    for keys, pattern in ((("i",), r"\d{8}-"), (("BSpace",), r"of 3 runs"), (("Enter",), r"frame 0"), ((">",), r"frame 4"), (("<",), r"frame 0"),
                          (("BSpace", "p"), r"over time"), (("BSpace",), r"of 3 runs")):
        s.keys(*keys)
        s.wait(pattern)
    s.resize(200, 60)
    s.wait(r"variant.*frames.*particles.*started")
    s.resize(30, 8)
    s.wait(r"too small")
    s.resize(80, 24)
    s.wait(r"3 of 3 runs")


@covers("runs.back", start=None, variables="export LC_ALL=C NO_COLOR=1;")
def ascii_alone(s):
    runs(s)
    s.keys("Space", "Space", "p")
    s.wait(r"over time")
    check(s.text().isascii(), "the plot is not ASCII")
    s.keys("BSpace", "Enter")
    s.wait(r"frame 0")
    check(s.text().isascii(), "frames are not ASCII")
    s.keys("Escape")
    s.wait(r"3 of 3 runs")


@covers("sweep.choose", "sweep.open", "sweep.run", "sweep.measure", "sweep.axes", "sweep.slice", "sweep.up", "sweep.down", "sweep.left", "sweep.right", "sweep.back", start=None, width=100, height=30)
def a_sweep_fills_its_grid(s):
    os.mkdir(f"{s.folder}/sweeps")
    with open(f"{s.folder}/sweeps/little.lua", "w", encoding="utf-8") as file:
        file.write(SWEEP.format(scenes=bench.SCENES))
    s.wait(r"\[Scenes\]")
    s.do("screen sweep")
    s.wait(r"\./sweeps/little.lua")
    s.do("sweep.choose little.lua")
    s.wait(r"Little .*0 done +of 12$")
    s.wait(r"break_stretch +0\.02, 0\.3")
    s.keys("r")
    s.wait(r"12 done +of 12$", patience=120)
    s.do("sweep.measure damage_max")
    s.wait(r"damage_max +of the last frame: break_stretch down, eta across")
    values = [row[0] for row in s.sql("SELECT value FROM final_measures AS m JOIN runs USING (run) WHERE m.name = 'damage_max' AND runs.frames_wanted = 1")]
    check(len(values) == 12, f"a measure of each run: {values}")
    s.wait(rf"\s{values[0]:.3g}".replace(".", r"\."))
    s.keys("Right", "Down")
    s.wait(r"^ 9/12 \d{8}-.* damage_max = ")
    s.keys("n")
    s.wait(r"^ 10/12 ")
    s.wait(r"pull .*held at 0\.8")
    s.keys("n", "Left", "Up")
    s.wait(r"^ 1/12 ")
    s.keys("a")
    s.wait(r"break_stretch down, pull across")
    s.keys("Enter")
    s.wait(r"frame 0 of 1")
    s.keys("G")
    s.wait(rf"- runs\.open {s.sql('SELECT id FROM runs ORDER BY run')[0][0]}", "the log has the run that was under the cursor")
    s.keys("G")
    s.do("screen sweep")
    s.keys("BSpace")
    s.wait(r"Sweeps at hand")
    s.do("sweep.open little.lua")
    s.wait(r"12 done +of 12$", "what is done is known again", patience=60)


@covers("sweep.stop", start=None, width=100, height=30)
def a_sweep_is_stopped(s):
    os.mkdir(f"{s.folder}/sweeps")
    with open(f"{s.folder}/sweeps/long.lua", "w", encoding="utf-8") as file:
        file.write(SWEEP.format(scenes=bench.SCENES).replace("frames = 1,", "frames = 2000,"))
    with open(f"{s.folder}/sweeps/wrong.lua", "w", encoding="utf-8") as file:
        file.write("return 1\n")
    s.wait(r"\[Scenes\]")
    s.do("screen sweep")
    s.do("sweep.choose wrong.lua")
    s.wait(r"wrong.lua")
    s.do("sweep.choose long.lua")
    s.wait(r"0 done +of 12$")
    s.do("sweep.run 2")
    s.until("two at a time", lambda: s.sql("SELECT count(*) FROM runs WHERE status = 'running'") == [[2]])
    s.keys("S")
    s.wait(r"The sweep has ended: stopped", patience=60)
    check(s.sql("SELECT count(*) FROM runs WHERE status = 'running'") == [[0]], "its runs ended with it")
