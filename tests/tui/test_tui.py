"""Drives the live screen (demo_tui, over a synthetic session) inside tmux and reads what a user would see.

Usage: test_tui.py DEMO [name ...]   Exit codes: 0 passed, 1 failed, 77 skipped (no tmux).
"""
import concurrent.futures
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import terminal
from terminal import COLOUR, PATIENCE, Failure, Screen, check

def demo(*arguments, **options):
    return Screen(" ".join(arguments), **options)


LONG = "--frames 5000 --frame-ms 40 --particles 3000"


def picture_colours(s):
    return set(re.findall(r"38;5;(\d+)", "".join(line.split("│")[0] for line in s.text(True).splitlines()[1:21])))


# ---- sizes ------------------------------------------------------------------------------------------------------------

def test_80x24():
    with demo(LONG, "--torn --warn") as s:
        s.running()
        for word in (r"sunder .*\[Run\].* Tube pull", r"time +\d\.\d\d/7\.00 s", r"step +\d", r"dt +1\.042e-03",
                     r"per frame +40\.0 ms", r"left +0:0\d:\d\d", r"particles +3 000", r"elapsed +0:00:\d\d", r"threads +2",
                     r"kernel +f32 avx2", r"kinetic +\S+e-\d\d", r"elastic +\S+e[-+]\d\d", r"fibre +\S+e[-+]\d\d", r"broken +\d+\.\d+ %",
                     r"mean +0\.\d{4}", r"largest +[01]\.\d{4}", r"0\.80–1\.00 ", r"space pause.*\? help",
                     r"the time step fell to a tenth", r"[▂-█]{3}"):
            s.wait(word)
        for line in s.text().splitlines():
            check(len(line) <= 80, f"a line of {len(line)} columns")


def test_numbers_are_the_session_s():
    with demo("--frames 4 --frame-ms 20 --particles 3000 --torn") as s:
        s.wait(r"done *$")
        shown = []
        for label in ("kinetic", "elastic", "fibre", "broken", "mean", "largest"):
            shown.append(s.wait(rf"{label} +(\d\S*) ").group(1))
        shares = [float(x) for x in re.findall(r"0–.*?(\d+\.\d+) %", s.text())]
        check(len(shares) == 5 and abs(sum(shares) - 100) < 0.1, f"shares of the histogram: {shares}")
        s.keys("q")
        check(s.wait(r"^last (.*)$").group(1).split() == shown, f"shown: {shown}")
        s.finished(0, outcome=0)


def test_200x60():
    with demo(LONG, "--torn", width=200, height=60) as s:
        s.running().wait(r"0\.96–1\.00 ")
        s.wait(r"work +\d")
        s.wait(r"effects ─")
        s.wait(r"elastic  fibres  damage")
        s.wait(r"Tube pull · full .*20260714-093012-k7f3 +running")


def test_40x10():
    with demo(LONG, width=40, height=10) as s:
        s.wait(r"\[Run\] +Tube pull")
        s.wait(r"frame \d+/5000")
        s.wait(r"broken ")
        s.wait(r"space pause")
        s.keys("?")
        s.wait(r"^keys ")
        s.keys(*["NPage"] * 12)
        s.wait(r"draw the screen anew")  # the last line of help can be reached
        s.keys("q", "q")
        s.wait(r"Stop the run after this frame\?")
        s.keys("q")
        s.finished(130, outcome=4)


def small(width, height):
    with demo(LONG, width=width, height=height) as s:
        s.wait(r"too small" if width > 9 else r"\S")
        s.keys("q", "y")
        s.resize(80, 24)
        s.finished(130)


def test_too_small():
    small(39, 10)


def test_too_low():
    small(80, 9)


def test_1x1():
    small(1, 1)


def test_resize_storm():
    generator = random.Random(1)
    with demo(LONG) as s:
        s.running()
        for i in range(60):
            s.resize(*((1, 1) if i % 20 == 7 else (generator.randint(1, 220), generator.randint(1, 70))))
            if i % 3 == 0:
                s.keys(generator.choice(["l", "m", "?", "g", "a", "c"]))
        for page in ("q", "Escape"):
            s.keys(page)
        s.keys("n")
        s.resize(80, 24)
        s.wait(r"^ sunder .*\[Run\]")
        s.keys("Q")
        s.finished(130, outcome=4)


# ---- terminals --------------------------------------------------------------------------------------------------------

def test_256_colours():
    with demo(LONG, "--torn") as s:
        s.running().wait(r"[\u2801-\u28ff]{4}")
        check(len(picture_colours(s)) >= 4, "hardly any colours in the picture")


def test_no_color():
    with demo(LONG, "--torn", variables="export NO_COLOR=1;") as s:
        s.running().wait(r"[\u2801-\u28ff]{2}")
        check(not re.search(COLOUR, s.text(True)), "colours under NO_COLOR")
        s.keys("c")
        s.wait(r"this terminal shows none")


def test_vt100():
    with demo(LONG, "--torn", term="vt100") as s:
        s.running().wait(r"[\u2801-\u28ff]{2}")
        check(not re.search(COLOUR, s.text(True)), "colours on a vt100")
        s.keys("q", "q")
        s.wait(r"^END")
        s.wait(r"^status 130")
        s.restored(first_line=False)  # a vt100 has no second screen to come back from


def test_8_colours():
    with demo(LONG, "--torn", term="xterm") as s:
        s.running()
        text = s.text(True)
        check(re.search(COLOUR, text) and not re.search(r"[34]8;5;", text), "not 8 colours")


def test_ascii():
    for variables, options in (("export LC_ALL=C;", ""), ("", "--ascii")):
        with demo(LONG, "--torn", options, variables=variables) as s:
            s.running().wait(r"^[^|]*[-.:=+*#%@]{4}[^|]*\|")
            s.keys("m")
            s.wait(r"Only ASCII")
            check(s.text().isascii(), "beyond ASCII")


def test_light_background_is_noticed():
    bars = []
    for hint in ("15;0", "0;15"):
        with demo(LONG, variables=f"export COLORFGBG='{hint}';") as s:
            s.running()
            bars.append(set(re.findall(r"48;5;(\d+)", s.text(True))))
    check(bars[0] != bars[1], "COLORFGBG changes nothing")


def test_a_theme_is_read_on_any_ground():
    """The light theme paints its own ground on a dark terminal; the dark one on a light one."""
    for hint, keys, ground in (("15;0", ["t"], "231"), ("0;15", [], None), ("0;15", ["t", "t"], "234"), ("15;0", [], None)):
        with demo(LONG, variables=f"export COLORFGBG='{hint}';") as s:
            s.running()
            if keys:
                s.keys(*keys)
                s.wait(r"Theme: (light|dark)")
            found = set(re.findall(r"48;5;(231|234)m", s.text(True)))
            check(found == ({ground} if ground else set()), f"the ground on a terminal of {hint} after {keys}: {found}")


def test_dumb_and_unknown_terminals_are_refused():
    for term, why in (("dumb", 'TERM is "dumb"'), ("nosuchterm", "no terminfo entry"), ("''", "TERM is not set")):
        with demo(LONG, term=term) as s:
            s.wait(rf"impossible: .*{why}")
            s.wait(r"^status 3")
    done = subprocess.run([DEMO], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
    check(done.returncode == 3 and "standard input is not a terminal" in done.stdout, done.stdout)


# ---- leaving ----------------------------------------------------------------------------------------------------------

def test_end_stays_until_q():
    with demo("--frames 5 --frame-ms 20 --particles 500") as s:
        s.wait(r"done *$")
        s.wait(r"Done\. Frames are in runs/")
        s.wait(r"frame +5/5")
        time.sleep(0.3)
        s.wait(r"done *$")
        s.keys("q")
        s.finished(0, outcome=0)


def test_leave_at_end():
    with demo("--frames 5 --frame-ms 20 --particles 500 --leave") as s:
        s.finished(0, outcome=0)


def test_failure_is_told():
    with demo("--frames 50 --frame-ms 20 --particles 500 --fail-at 8") as s:
        s.wait(r"failed *$")
        s.wait(r"diverged at step 313: particle 1234")
        s.keys("q")
        s.finished(1, outcome=1)


def held(function):
    """A run whose frame is not finished before the file is gone."""
    with tempfile.NamedTemporaryFile(prefix="sunder-hold-", delete=False) as file:
        pass
    try:
        with demo(f"--frames 500 --frame-ms 20 --particles 500 --hold {file.name}") as s:
            function(s.running(), file.name)
            s.finished(130, outcome=4)
    finally:
        if os.path.exists(file.name):
            os.remove(file.name)


def test_ctrl_c_finishes_the_frame():
    def stop(s, hold):
        s.keys("C-c")
        s.wait(r"stopping *$")
        s.wait(r"Finishing the frame")
        os.remove(hold)
    held(stop)


def test_second_ctrl_c_abandons_it():
    def stop(s, _):
        s.keys("C-c")
        s.wait(r"stopping *$")
        s.keys("C-c")
    held(stop)


def test_ctrl_c_while_paused_and_at_the_end():
    with demo(LONG, "--paused") as s:
        s.wait(r"paused *$")
        s.keys("C-c")
        s.finished(130, outcome=4)
    with demo("--frames 3 --frame-ms 10 --particles 500") as s:
        s.wait(r"done *$")
        s.keys("C-c")
        s.finished(0, outcome=0)


def soft_signal(number):
    with demo(LONG) as s:
        s.running()
        os.kill(s.pid(), number)
        s.finished(130, outcome=4)


def test_sigterm():
    soft_signal(signal.SIGTERM)


def test_sighup():
    soft_signal(signal.SIGHUP)


def test_terminal_that_goes_away():
    """The terminal closes: the run is stopped properly and the process ends."""
    with demo("--frames 5000 --frame-ms 20 --particles 500") as s:
        pid = s.running().pid()
        s.tmux("kill-server", fatal=False)
        end = time.monotonic() + PATIENCE
        while os.path.exists(f"/proc/{pid}"):
            check(time.monotonic() < end, "the process outlives its terminal")
            time.sleep(0.05)


def test_exit_from_elsewhere():
    with demo(LONG, "--exit-after 500") as s:
        s.finished(7)


def test_suspend_and_come_back():
    with Screen(shell=True) as s:
        s.type(f"PS1='ready> '; clear; stty -g > {s.folder}/first; {DEMO} {LONG}; stty -g > {s.folder}/after\n")
        s.running().keys("C-z")
        s.wait(r"Stopped")
        s.wait(r"^ready>")
        s.type(f"stty -g > {s.folder}/before; echo saved\n")
        s.wait(r"^saved")
        with open(os.path.join(s.folder, "first"), encoding="ascii") as file:
            first = file.read()
        with open(os.path.join(s.folder, "before"), encoding="ascii") as file:
            check(file.read() == first, "terminal modes differ while stopped")
        s.resize(100, 30)
        s.type("fg\n")
        s.running()
        s.wait(r"^ sunder .*\[Run\]")
        frame = s.frame()
        s.wait(rf"frame +(?!{frame}/)\d+/")
        s.keys("Q")
        s.wait(r"^outcome 4:")
        s.type(f"stty -g > {s.folder}/after; echo over\n")
        s.wait(r"^over")
        s.restored(first_line=False)


def test_stop_that_cannot_be_caught():
    """SIGSTOP, rubbish on the screen, SIGCONT: all is drawn anew."""
    with demo(LONG) as s:
        pid = s.running().pid()
        tty = s.tmux("display", "-p", "#{pane_tty}").strip()
        os.kill(pid, signal.SIGSTOP)
        with open(tty, "w", encoding="ascii") as terminal:
            terminal.write("\033[2J\033[5;5HRUBBISH")
        s.wait("RUBBISH")
        os.kill(pid, signal.SIGCONT)
        s.wait("RUBBISH", absent=True)
        s.wait(r"^ sunder .*\[Run\]")


def fatal(number):
    # In the simulating thread, with something printed just before.
    with demo(f"{LONG} --print --crash-at 6 {number}") as s:
        s.wait(r"^END")
        s.wait(rf"^status {128 + number}$")
        s.wait(r"library: a complaint about frame 6")
        s.restored(first_line=False)
    # In whatever thread the kernel chooses.
    with demo(LONG) as s:
        s.running()
        os.kill(s.pid(), number)
        s.finished(128 + number)


# ---- manners ----------------------------------------------------------------------------------------------------------

def test_printed_text_stays_off_the_screen():
    with demo(LONG, "--print") as s:
        s.running().wait(r"frame +[1-9]\d*/")
        s.wait("A library has printed something")
        check("library:" not in s.text(), "printed text on the screen")
        s.keys("g")
        s.wait(r"library: a complaint about frame \d+")
        s.wait(r"library: standard output, frame \d+")
        last = int(re.findall(r"complaint about frame (\d+)", s.text())[-1])
        s.wait(rf"complaint about frame {last + 5}")  # the page follows
        s.keys("q", "Q")
        s.wait(r"^library: standard output, frame \d+")
        s.wait(r"^status 130")


def test_scene_without_damage():
    with demo(LONG, "--undamaged") as s:
        s.running().wait("this scene does not damage anything")
        check("particles by damage" not in s.text(), "a histogram of nothing")


# ---- running them -----------------------------------------------------------------------------------------------------

def collect():
    tests = {name: function for name, function in globals().items() if name.startswith("test_")}
    for name in ("SEGV", "ABRT", "BUS", "FPE", "ILL", "QUIT", "TRAP", "SYS", "XCPU"):
        number = getattr(signal, "SIG" + name)
        tests[f"fatal_{name}"] = lambda number=number: fatal(int(number))
    return tests


def run(name, function):
    try:
        function()
        return name, None
    except (Failure, OSError, subprocess.TimeoutExpired) as problem:
        return name, str(problem) or repr(problem)


def main():
    if not shutil.which("tmux"):
        print("skipped: tmux is not installed")
        return 77
    tests = collect()
    chosen = sys.argv[2:] or list(tests)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda n: run(n, tests[n]), chosen))
    for name, problem in results:
        print(f"FAIL {name}: {problem}" if problem else f"ok   {name}")
    failed = sum(problem is not None for _, problem in results)
    print(f"{len(results)} tests, {failed} failed")
    return 1 if failed or not results else 0


if __name__ == "__main__":
    DEMO = terminal.PROGRAM = os.path.abspath(sys.argv[1])
    sys.exit(main())
