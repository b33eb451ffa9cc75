"""Every screen of the program in every kind of terminal: sizes, colours, character sets, signals.

Usage: test_manners.py SUNDER SCENES [name ...]   Exit codes: 0 passed, 1 failed, 77 skipped (no tmux).
"""
import json
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time

import bench
from bench import Bench, check, test
from terminal import COLOUR

SMALL_RUN = "solid/tube_pull.lua --set particles=900 --frames 3"


def screens():
    """The names of all screens, from the program."""
    listed = json.loads(subprocess.run([bench.SUNDER, "help", "actions", "--json"], capture_output=True, text=True, check=True).stdout)
    return list(dict.fromkeys(action["screen"] for action in listed if action["screen"]))


def each_screen(s):
    """Goes to each screen in turn."""
    for name in screens():
        s.do(f"screen {name}")
        s.wait(rf"\[{name.capitalize()}\]")
        time.sleep(0.3)
        yield name


# ---- sizes -----------------------------------------------------------------------------------------------------------

@test
def every_screen_fits_its_terminal():
    for width, height in ((80, 24), (200, 60), (40, 10)):
        with Bench(SMALL_RUN, width=width, height=height) as s:
            s.wait(r"\[Run\]")
            for name in each_screen(s):
                lines = s.text().splitlines()
                check(len(lines) <= height and max(len(line) for line in lines) <= width, f"{name} at {width}x{height}")
                check(re.search(r"(help|quit)", lines[height - 1] if len(lines) >= height else lines[-1]), f"{name} at {width}x{height} has no key line:\n{s.text()}")
            s.keys("F3", "q")
            s.wait(r"^END")


@test
def too_small_still_quits_from_every_screen():
    for i, _ in enumerate(screens()):
        for size in ((39, 10), (80, 9), (1, 1)):
            with Bench(SMALL_RUN + "000") as s:
                s.wait(r"frame +[1-9]")
                s.keys(f"F{i + 2}")
                s.resize(39, 10)
                s.wait(r"too small") # nothing can be read from 1×1: what is too small already gets there
                s.resize(*size)
                s.wait(r"too small" if size != (1, 1) else r"")
                s.keys("q", "y")
                s.resize(80, 24)
                s.wait(r"^END")
                s.wait(r"^status 130")


@test
def resize_storm_over_all_screens():
    generator = random.Random(5)
    count = len(screens())
    with Bench(SMALL_RUN + "000") as s:
        s.wait(r"frame +[1-9]")
        for i in range(60):
            s.resize(*((1, 1) if i % 20 == 7 else (generator.randint(1, 220), generator.randint(1, 70))))
            if i % 2 == 0:
                s.keys(generator.choice([f"F{k + 2}" for k in range(count)] + ["Tab", "F1", "Down", "Escape"]))
        s.keys("Escape")
        s.resize(80, 24)
        s.keys("F3")
        s.wait(r"\[Run\]")
        os.kill(s.pid(), signal.SIGTERM)
        s.finished(130)


# ---- kinds of terminals ----------------------------------------------------------------------------------------------

@test
def no_colour_where_there_is_none():
    for variables, term in (("export NO_COLOR=1;", "xterm-256color"), ("", "vt100")):
        with Bench(SMALL_RUN, variables=variables, term=term) as s:
            s.wait(r"\[Run\]")
            for name in each_screen(s):
                check(not re.search(COLOUR, s.text(True)), f"{name}: colours with {variables or term}")
            s.do("screen run")
            s.keys("q")
            s.wait(r"^END")  # by then its modes are in a file
            s.wait(r"^status 0")
            s.restored(first_line=False)


@test
def eight_colours():
    with Bench(SMALL_RUN, term="xterm") as s:
        s.wait(r"\[Run\]")
        for name in each_screen(s):
            check(not re.search(r"[34]8;5;", s.text(True)), f"{name}: more than 8 colours")


@test
def only_ascii_under_a_plain_locale():
    with Bench(SMALL_RUN, variables="export LC_ALL=C;") as s:
        s.wait(r"\[Run\]")
        for name in each_screen(s):
            check(s.text().isascii(), f"{name}: beyond ASCII:\n{s.text()}")
            check("?" not in re.sub(r"\?  F1|\? help|\bstop\?|help\?", "", s.text().replace("? ", "")), f"{name}: a character that has no ASCII:\n{s.text()}")


@test
def without_a_terminal_it_runs_plainly():
    environment = dict(os.environ, XDG_DATA_HOME=tempfile.mkdtemp(prefix="sunder-plain-"), TERM="dumb")
    scene = [f"{bench.SCENES}/solid/tube_pull.lua", "--set", "particles=900", "--frames", "2"]
    done = subprocess.run([bench.SUNDER, "run", *scene, "--tui"], stdin=subprocess.DEVNULL, capture_output=True, text=True, env=environment, timeout=60,
                          check=False)
    check(done.returncode == 0 and "the live view is off" in done.stderr and "frame 2/2" in done.stdout, f"{done.stdout}{done.stderr}")
    done = subprocess.run([bench.SUNDER], stdin=subprocess.DEVNULL, capture_output=True, text=True, env=environment, timeout=60, check=False)
    check(done.returncode == 0 and "sunder run" in done.stdout, "sunder alone does not help")
    shutil.rmtree(environment["XDG_DATA_HOME"])
    with Bench(None, term="dumb") as s:
        s.wait(r"the workbench is off: TERM is .dumb.")
        s.wait(r"^status 0")


@test
def true_colour_on_request():
    tic, infocmp = shutil.which("tic"), shutil.which("infocmp")
    if not tic or not infocmp:
        return
    with tempfile.TemporaryDirectory(prefix="sunder-terminfo-") as folder:
        text = subprocess.run([infocmp, "xterm-256color"], capture_output=True, text=True, check=True).stdout
        text = re.sub(r"^xterm-256color\|", "xterm-direct|", text, flags=re.M)
        text = re.sub(r"\tccc,|\binitc=[^\n]*?,(?= \w+=|\n)|\boc=[^,]*,", "", text)
        text = re.sub(r"setab=[^\n]*?%;m,", r"setab=\\E[%?%p1%{8}%<%t4%p1%d%e48;2;%p1%{65536}%/%d;%p1%{256}%/%{255}%\&%d;%p1%{255}%\&%d%;m,", text)
        text = re.sub(r"setaf=[^\n]*?%;m,", r"setaf=\\E[%?%p1%{8}%<%t3%p1%d%e38;2;%p1%{65536}%/%d;%p1%{256}%/%{255}%\&%d;%p1%{255}%\&%d%;m,", text)
        text = re.sub(r"colors#\w+", "colors#0x1000000", text)
        text = re.sub(r"\bam,", "am, RGB,", text, count=1)
        path = os.path.join(folder, "direct.ti")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run([tic, "-x", "-o", folder, path], capture_output=True, check=True)
        with Bench(SMALL_RUN, config='return { colours = "true" }\n', variables=f"export TERMINFO_DIRS={folder}:/lib/terminfo:/usr/share/terminfo;") as s:
            s.tmux("set", "-g", "default-terminal", "tmux-256color")
            s.wait(r"done *$")
            s.until("true colours", lambda: re.search(r"[34]8;2;\d+;\d+;\d+", s.text(True)))
    with Bench(SMALL_RUN, config='return { colours = "true" }\n') as s:
        s.wait(r"\[Run\]")
        text = s.text()
        check("xterm-direct" in text or re.search(r"[34]8;2;", s.text(True)), f"no word about true colour:\n{text}")


# ---- signals ---------------------------------------------------------------------------------------------------------

@test
def fatal_signals_give_the_terminal_back_from_every_screen():
    count = len(screens())
    for i, name in enumerate(("SEGV", "ABRT", "BUS", "FPE", "ILL", "QUIT", "TRAP", "SYS", "XCPU")):
        number = int(getattr(signal, "SIG" + name))
        with Bench(SMALL_RUN + "000") as s:
            s.wait(r"frame +[1-9]")
            s.keys(f"F{i % count + 2}")
            time.sleep(0.3)
            os.kill(s.pid(), number)
            s.finished(128 + number)


@test
def stop_and_continue_on_the_scenes():
    with Bench(None) as s:
        s.wait(r"\[Scenes\]")
        os.kill(s.pid(), signal.SIGTSTP)
        time.sleep(0.5)
        os.kill(s.pid(), signal.SIGCONT)
        s.wait(r"\[Scenes\]")
        s.keys("C-c")
        s.finished(0)


if __name__ == "__main__":
    bench.run_tests(__doc__)
