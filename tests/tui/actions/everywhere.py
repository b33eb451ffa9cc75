"""The actions that every screen has."""
import os
import time

from bench import check, covers


@covers("help")
def help_page(s):
    s.paused().keys("?")
    s.shows(r"^keys", r"run\.pause")
    for key in ("?", "q", "Escape"):
        s.keys(key)
        s.wait(r"^keys", absent=True)
        s.keys("F1")
        s.wait(r"^keys")


@covers("palette")
def palette(s):
    s.paused().keys(":")
    s.type("run.til")
    s.shows(r"run\.tilt-up +run\.tilt-down")
    s.keys("Tab")
    s.wait(r"^:run\.tilt-up")
    s.keys("Tab")
    s.wait(r"^:run\.tilt-down")
    s.keys("Escape")
    s.wait(r"^:", absent=True)
    s.do("nonsense")
    s.shows(r"nonsense.*none of that name")
    s.keys(":", "Up")  # the history
    s.wait(r"^:nonsense")
    s.keys("C-u")
    s.type("thxme lght")
    for _ in range(9):
        s.keys("Left")
    s.keys("DC")  # "thxme" lost its x's neighbour; put right below
    s.keys("Escape")


@covers("screen", "next-screen")
def screens(s):
    s.paused().keys("F2")
    s.wait(r"\[Scenes\]")
    s.keys("Tab")
    s.wait(r"\[Run\]")
    s.keys("BTab")
    s.wait(r"\[Scenes\]")
    s.do("screen console")
    s.wait(r"\[Console\]")
    s.do("screen runn")
    s.wait(r"did\s+you\s+mean")


@covers("start", start=None)
def start(s):
    s.wait(r"\[Scenes\]")
    s.do("start tube_pull --set particles=900 --set duration=0.2 --precision f64 --frames 3")
    s.shows(r"\[Run\]", r"done *$", r"frame +3/3")
    rows = s.sql("SELECT precision, frames FROM runs")
    check(rows == [["f64", 3]], f"in the ledger: {rows}")
    s.do("start tube_pul")
    s.wait(r"tube_pul")
    s.do("start tube_pull --sett a=b")
    s.wait(r"did\s+you\s+mean")


@covers("quit")
def quit_asks(s):
    s.paused().keys("q")
    s.wait(r"Stop the run after this frame\?")
    s.keys("n")
    s.wait(r"Stop the run", absent=True)
    s.keys("q")
    s.wait(r"Stop the run after this frame\?")
    s.keys("y")
    s.finished(130)
    check(s.sql("SELECT status FROM runs") == [["interrupted"]], "the ledger does not say that it was stopped")


@covers("leave")
def leave(s):
    s.paused().keys("Q")
    s.finished(130)


@covers("theme")
def theme(s):
    s.paused().do("theme light")
    s.wait(r"Theme: light")
    light = s.text(True)
    s.keys("t")
    s.wait(r"Theme: colour-blind")
    s.keys("t")
    s.wait(r"Theme: dark")
    check(s.text(True).splitlines()[0] != light.splitlines()[0], "dark and light look alike")
    s.do("theme lightt")
    s.wait(r"did\s+you\s+mean")


@covers("mouse")
def mouse(s):
    s.paused().keys("M")
    s.wait(r"The mouse is the workbench's")
    s.until("the mouse", lambda: s.tmux("display", "-p", "#{mouse_any_flag}#{mouse_standard_flag}#{mouse_button_flag}").strip() != "000")
    s.do("mouse off")
    s.wait(r"The mouse is the terminal's")
    s.keys("M", "Q")  # left with the mouse on
    s.finished(130)
    check(s.tmux("display", "-p", "#{mouse_any_flag}#{mouse_standard_flag}#{mouse_button_flag}").strip() == "000", "the mouse was kept")


@covers("log")
def log_page(s):
    s.paused().keys("g")
    s.shows(r"printed by libraries", r"Nothing so far")
    s.keys("g")
    s.wait(r"printed by libraries", absent=True)


@covers("commands", "save-commands")
def commands(s):
    s.paused().keys("t", "G")
    s.shows(r"^commands ─", r"^ - start \S+tube_pull\.lua .*particles=1200", r"^ \d+ theme")
    s.keys("q")
    s.do("save-commands kept.log")
    s.wait(r"are in kept\.log")
    with open(os.path.join(s.folder, "kept.log"), encoding="utf-8") as file:
        kept = file.read()
    check(kept == s.commands() and "theme" in kept, f"the file and the run's log differ: {kept}")
    s.do("save-commands /nowhere/kept.log")
    s.wait(r"cannot write /nowhere")


@covers("redraw")
def redraw(s):
    s.paused()
    with open(s.tmux("display", "-p", "#{pane_tty}").strip(), "w", encoding="ascii") as terminal:
        terminal.write("\033[5;5HRUBBISH")
    s.wait("RUBBISH")
    time.sleep(0.1)
    s.keys("C-l")
    s.wait("RUBBISH", absent=True)
