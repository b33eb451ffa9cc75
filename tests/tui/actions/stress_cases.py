"""The Stress screen: the hard cases are listed, run, filtered, and their runs opened, over a ledger of its own."""
from bench import check, covers


def cases(s):
    s.wait(r"\[Scenes\]")
    s.do("screen stress")
    s.wait(r"Hard cases +0 hold +of [1-9]\d+ +f32$", "the list of cases", patience=60)


def count(s, query):
    return s.sql(query)[0][0]


VERDICTS = "SELECT count(*) FROM events WHERE kind = 'verdict' AND text LIKE '{}%'"


@covers("stress.up", "stress.down", "stress.page-up", "stress.page-down", "stress.effect", "stress.trouble", "stress.precision", start=None, width=120, height=40)
def cases_are_looked_through(s):
    cases(s)
    first = s.wait(r" (\S+) ────").group(1)
    s.keys("Down")
    s.wait(rf" (?!{first} )\S+ ────")
    s.keys("Up")
    s.wait(rf" {first} ────")
    s.keys("NPage")
    s.wait(rf" (?!{first} )\S+ ────")
    s.keys("PPage")
    s.wait(rf" {first} ────")
    s.do("stress.effect self_contact")
    s.wait(r"only self_contact")
    s.wait(r"sheet_crumple/crumple")
    s.wait(r"spin/slow", absent=True)
    s.do("stress.effect nonsense")
    s.wait(r"an effect, or all")
    s.do("stress.effect all")
    s.wait(r"only", absent=True)
    s.keys("e")
    s.wait(r"only plastic")
    s.do("stress.effect all")
    s.keys("f")
    s.wait(r"only failing")
    s.wait(r"No case fits")
    s.keys("f")
    s.wait(rf" {first} ────")
    s.keys("p")
    s.wait(r"of [1-9]\d+ +f64$", patience=60)
    s.do("stress.precision f32")
    s.wait(r"of [1-9]\d+ +f32$", patience=60)


@covers("stress.run", "stress.mark", "stress.unmark", "stress.open", start=None, width=140, height=40)
def chosen_cases_are_run(s):
    cases(s)
    s.keys("Enter")
    s.wait(r"no run of it yet")
    s.do("stress.mark few/single")
    s.do("stress.mark domain/leaves")
    s.wait(r"2 marked")
    s.keys("r")
    s.wait(r"Hard cases +2 hold", patience=60)
    s.until("both verdicts", lambda: count(s, VERDICTS.format("")) == 2)
    check(count(s, VERDICTS.format("stops")) == 1 and count(s, VERDICTS.format("holds")) == 1, "one holds, one stops as it should")
    s.keys("u")
    s.wait(r"marked", absent=True)
    s.do("stress.run inversion/collapsed_matrix")
    s.wait(r"1 known limits", patience=60)
    s.keys("f")
    s.wait(r"no +determinant_end +\S+ \(at least 0\.9\)")
    s.keys("f")
    s.do("stress.open few/single")
    s.wait(r"frame 0 of 20")


@covers("stress.run-all", "stress.stop", start=None, width=100, height=30)
def running_is_stopped(s):
    cases(s)
    s.keys("S")
    s.wait(r"No cases are being run")
    s.keys("R")
    s.wait(r"running [1-9]")
    s.until("a verdict", lambda: count(s, VERDICTS.format("")) > 0)
    s.keys("S")
    s.wait(r"The hard cases have ended: stopped", patience=60)
    check(count(s, "SELECT count(*) FROM runs WHERE status = 'running'") == 0, "its runs ended with it")
    check(count(s, VERDICTS.format("")) < 20, "and not all were made")
