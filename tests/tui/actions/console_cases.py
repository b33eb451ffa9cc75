"""The Console screen."""
from bench import check, covers


def console(s):
    s.paused().do("screen console")
    s.wait(r"\[Console\]")
    return s


def line(s, text):
    s.type(text)
    s.keys("Enter")


@covers("console.run")
def run(s):
    console(s)
    line(s, "1 + 2")
    s.wait(r"^ 3$")
    line(s, "x = 20; print(x * 2)")
    s.wait(r"^ 40$")
    line(s, "x")
    s.wait(r"^ 20$")
    line(s, "measures().frames")
    s.wait(r"^ 48$")
    line(s, "knob('eta')")
    s.wait(r"^ 0\.\d+$")
    line(s, "turn('eta', 0.25)")
    line(s, "step()")
    s.until("the turn in the ledger", lambda: s.sql("SELECT value FROM knob_turns WHERE path LIKE '%damage.eta'") == [["0.25"]])
    line(s, "#runs('particles > 0')")
    s.wait(r"^ 1$")
    line(s, "query('SELECT count(*) AS n FROM runs')[1].n + 6")
    s.wait(r"^ 7$")
    line(s, "turn('etaa', 1)")
    s.wait(r"did\s+you\s+mean")
    line(s, "sunder.recipe('tube').damage.eta")
    s.wait(r"^ 0\.\d+$")
    line(s, "error('mine')")
    s.wait(r"^ mine$")
    line(s, "os.execute('true')")
    s.wait(r"sandbox")
    line(s, "sunder.sphere")
    s.wait(r"function")
    check("run.turn" in s.commands(), "the turn is not in the command log")


@covers("console.run", start=None)
def starts(s):
    s.wait(r"\[Scenes\]")
    s.do("screen console")
    s.wait(r"\[Console\]")
    line(s, "knobs()")
    s.wait(r"^ there is no run")
    line(s, "start('tube_pull --set particles=900 --frames 9')")
    s.wait(r"(running|done) *$")
    line(s, "run_to(7); wait(); measures().frame")
    s.wait(r"'wait'|near|syntax")  # statements are no expression: nothing has been run
    line(s, "run_to(7); wait(); print('at', measures().frame)")
    s.wait(r"^ at\S* *[7-9]$")
    s.wait(r"\[Console\]")


@covers("console.interrupt", "console.clear")
def stops(s):
    console(s)
    line(s, "while true do end")
    s.wait(r"running; Esc stops")
    s.changes("F3")  # the screen is not held up
    s.wait(r"\[Run\]")
    s.do("screen console")
    s.keys("Escape")
    s.wait(r"running; Esc stops", absent=True)
    s.wait(r"stopped")
    line(s, "5 * 5")
    s.wait(r"^ 25$")
    s.keys("C-k")
    s.wait(r"^ 25$", absent=True)


@covers("console.complete", "console.previous", "console.next", "console.scroll-up", "console.scroll-down")
def typing(s):
    console(s)
    s.type("meas")
    s.keys("Tab")
    s.wait(r"^> measures\(")
    s.keys("Escape")
    s.type("knob('tube.damage.et")
    s.keys("Tab")
    s.wait(r"^> knob\('tube\.damage\.eta")
    s.keys("Escape")
    line(s, "for i = 1, 60 do print('line', i) end")
    s.wait(r"line\S* *60")
    s.keys("PPage")
    s.wait(r"line\S* *60", absent=True)
    s.keys("NPage")
    s.wait(r"line\S* *60")
    line(s, "7 + 1")
    s.wait(r"^ 8$")
    s.keys("Up", "Up")
    s.wait(r"^> for i")
    s.keys("Down")
    s.wait(r"^> 7 \+ 1")
