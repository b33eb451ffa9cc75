"""The workbench in a terminal of its own, over a ledger of its own: what the cases of every screen drive."""
import os
import shutil
import sqlite3
import sys
import tempfile
import time
import traceback

import terminal
from terminal import PATIENCE, Failure, Screen, check

SUNDER, SCENES = "", ""
CASES, TESTS = {}, {}


def use_arguments(usage):
    """Takes the program and its scenes from the command line; ends with the code of a wrong usage, or of a skipped test without tmux."""
    global SUNDER, SCENES
    if len(sys.argv) < 3:
        print(usage)
        sys.exit(2)
    if not shutil.which("tmux"):
        print("skipped: tmux is not installed")
        sys.exit(77)
    SUNDER, SCENES = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    terminal.PROGRAM = SUNDER


def test(function):
    """This function is a test, by its name."""
    TESTS[function.__name__] = function
    return function


def run_tests(usage):
    """Runs the tests that the command line names, or all of them, and ends the program."""
    use_arguments(usage)
    failed = 0
    for name in sys.argv[3:] or TESTS:
        try:
            TESTS[name]()
            print(f"ok   {name}", flush=True)
        except Exception as error:  # whatever it is, it is this test's failure
            failed += 1
            if not isinstance(error, Failure):
                traceback.print_exc()
            print(f"FAIL {name}: {error if isinstance(error, Failure) else repr(error)}", flush=True)
    print(f"{len(sys.argv[3:] or TESTS)} tests, {failed} failed")
    sys.exit(1 if failed or not TESTS else 0)


class Case:
    def __init__(self, names, function, options):
        self.names, self.function, self.options = names, function, options


def covers(*names, **options):
    """This function presses these actions; options are Bench's."""
    def register(function):
        case = Case(names, function, options)
        for name in names:
            CASES.setdefault(name, []).append(case)
        return function
    return register


class Bench:
    """start: the scene and options of `sunder run --tui`; None: `sunder` alone, which opens the workbench on its scenes. With --paused nothing
    of a run is over before a key of the case lets it go on, however fast the machine."""

    def __init__(self, start="solid/tube_pull.lua --set particles=1200 --set duration=2 --paused", width=80, height=24, config=None, replay=None,
                 variables="", **options):
        self.folder = tempfile.mkdtemp(prefix="sunder-bench-")
        self.ledger = os.path.join(self.folder, "ledger.db")
        if config is not None:
            os.makedirs(os.path.join(self.folder, "sunder"))
            with open(os.path.join(self.folder, "sunder", "config.lua"), "w", encoding="utf-8") as file:
                file.write(config)
        if replay:
            arguments = f"--db {self.ledger} --replay {replay}"
        elif start is None:
            arguments = f"--db {self.ledger}"
        else:
            arguments = f"run {SCENES}/{start} --threads 1 --db {self.ledger} --tui"
        setting = f"export XDG_DATA_HOME={self.folder} XDG_CONFIG_HOME={self.folder} HOME={self.folder}; cd {self.folder};"
        self.screen = Screen(arguments, width=width, height=height, variables=setting + variables, **options)

    def __enter__(self):
        self.screen.__enter__()
        return self

    def __exit__(self, *error):
        self.screen.__exit__(*error)
        shutil.rmtree(self.folder, ignore_errors=True)

    def __getattr__(self, name):
        return getattr(self.screen, name)

    def sql(self, query):
        with sqlite3.connect(self.ledger) as connection:
            return [list(row) for row in connection.execute(query)]

    def until(self, what, condition):
        """Waits until a function says so."""
        end = time.monotonic() + PATIENCE
        while True:
            answer = condition()
            if answer:
                return answer
            check(time.monotonic() < end, f"{what} does not come about:\n{self.text()}")
            time.sleep(0.05)

    def paused(self):
        """A run that was started --paused, at its first frame."""
        self.wait(r"paused *$", "the run")
        self.wait(r"frame +0/")
        self.keys("s")
        self.wait(r"frame +1/")
        self.wait(r"paused *$")
        return self

    def do(self, text):
        """Types an action into the palette."""
        self.keys(":")
        self.wait(r"^:")
        self.type(text)
        self.keys("Enter")

    def shows(self, *patterns):
        for pattern in patterns:
            self.wait(pattern)

    def changes(self, *keys):
        """Presses keys and waits until the screen is another."""
        before = self.text()
        self.keys(*keys)
        self.until(f"an effect of {keys}", lambda: self.text() != before)

    def commands(self):
        """The command log of the newest run."""
        path = os.path.join(self.sql("SELECT output FROM runs ORDER BY run DESC LIMIT 1")[0][0], "commands.log")
        # The run is in the ledger a moment before the workbench has taken it up.
        self.until("the run's command log", lambda: os.path.exists(path))
        with open(path, encoding="utf-8") as file:
            return file.read()
