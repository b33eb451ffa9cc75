"""The workbench in a terminal of its own, over a ledger of its own: what the cases of every screen drive."""
import json
import os
import re
import shutil
import subprocess
import tempfile
import time

import test_tui
from test_tui import PATIENCE, Failure, Screen, check  # noqa: F401 (cases import them from here)

SUNDER, SCENES = "", ""
CASES = {}


def use(sunder, scenes):
    global SUNDER, SCENES
    SUNDER, SCENES = sunder, scenes
    test_tui.DEMO = sunder


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
    """start: the scene and options of `sunder run --tui`; None: `sunder` alone, which opens the workbench on its scenes."""

    def __init__(self, start="solid/tube_pull.lua --set particles=1200 --set duration=2", width=80, height=24, config=None, replay=None,
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
        done = subprocess.run(["sqlite3", "-json", self.ledger, query], capture_output=True, text=True, check=True)
        return [list(row.values()) for row in json.loads(done.stdout or "[]")]

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
        """Paused at some frame from 1 on."""
        self.wait(r"(running|paused) *$", "the run")
        self.wait(r"frame +[1-9]\d*/")
        if not re.search(r"paused *$", self.text(), re.M):
            self.keys("Space")
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
