"""A program with a screen inside tmux: keys for it, what a user would see, and whether it gives the terminal back."""
import os
import re
import shutil
import subprocess
import tempfile
import time

PROGRAM = ""  # set by who imports this
PATIENCE = 20.0  # seconds that anything may take on a busy machine
COLOUR = r"\033\[[0-9;]*(?:3[0-7]|4[0-7]|9[0-7]|38;5;\d+|48;5;\d+)[;m]"  # a colour, of any depth


class Failure(Exception):
    pass


def check(condition, what):
    if not condition:
        raise Failure(what)


class Screen:
    """The program in a terminal of its own."""

    count = 0

    def __init__(self, arguments="", width=80, height=24, term="xterm-256color", variables="", shell=False):
        Screen.count += 1
        self.folder = tempfile.mkdtemp(prefix="sunder-tui-")
        self.socket = os.path.join(self.folder, "tmux")
        environment = {k: v for k, v in os.environ.items() if k not in ("TMUX", "NO_COLOR", "COLORFGBG", "LC_ALL")}
        environment["LC_ALL"] = "C.UTF-8"
        setting = f"export TERM={term} LC_ALL=C.UTF-8; unset TMUX; {variables}"
        # Sanitizers handle fatal signals themselves unless told not to.
        quiet = ":".join(f"handle_{name}=0" for name in ("segv", "abort", "sigbus", "sigfpe", "sigill", "sigtrap"))
        setting += "".join(f" export {tool}_OPTIONS=${{{tool}_OPTIONS}}:{quiet};" for tool in ("ASAN", "TSAN", "UBSAN"))
        if shell:
            command = f"{setting} exec bash --norc --noprofile -i"
        else:
            # The trap keeps the shell alive through Ctrl-C, which reaches it as well; exec makes the pid the program's.
            command = (f"{setting} ulimit -c 0; trap : INT; stty -g > {self.folder}/before; echo BEFORE; "
                       f"bash -c 'echo $$ > {self.folder}/pid; exec {PROGRAM} {arguments}'; "
                       f"echo \"status $?\"; stty -g > {self.folder}/after; echo END; sleep 1000")
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", str(width), "-y", str(height), "bash", "-c", command,
                  environment=environment)
        self.tmux("set", "-g", "escape-time", "0")
        self.tmux("set", "-g", "status", "off")
        self.resize(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.tmux("kill-server", fatal=False)
        for _ in range(20):  # a dying shell may still write a file into it
            shutil.rmtree(self.folder, ignore_errors=True)
            if not os.path.exists(self.folder):
                break
            time.sleep(0.05)

    def tmux(self, *arguments, fatal=True, environment=None):
        done = subprocess.run(["tmux", "-u", "-S", self.socket, *arguments], capture_output=True, text=True,
                              env=environment, timeout=PATIENCE)
        if fatal and done.returncode != 0:
            raise Failure(f"tmux {arguments[0]}: {done.stderr.strip()}")
        return done.stdout

    def resize(self, width, height):
        self.tmux("resize-window", "-x", str(width), "-y", str(height))

    def keys(self, *names):
        self.tmux("send-keys", *names)

    def type(self, text):
        self.tmux("send-keys", "-l", text)

    def text(self, colours=False):
        return self.tmux("capture-pane", "-p", *(["-e"] if colours else []))

    def wait(self, pattern, what=None, absent=False, patience=PATIENCE):
        """Waits until the screen matches (or no longer matches) the pattern; returns the match."""
        end = time.monotonic() + patience
        while True:
            text = self.text()
            found = re.search(pattern, text, re.M)
            if bool(found) != absent:
                return found
            if time.monotonic() > end:
                raise Failure(f"{what or pattern!r} {'stays' if absent else 'does not show'} on:\n{text}")
            time.sleep(0.03)

    def number(self, pattern):
        return float(self.wait(pattern).group(1))

    def frame(self):
        return int(self.number(r"frame +(\d+)/"))

    def pid(self):
        with open(os.path.join(self.folder, "pid"), encoding="ascii") as file:
            return int(file.read())

    def running(self):
        self.wait(r"(running|paused) *$", "the run")
        self.wait(r"frame +\d+/")
        return self

    def finished(self, status, outcome=None):
        """The program has left with this status, the terminal is as it was, and what was on it before is back."""
        self.wait(r"^END", "the shell after the screen")
        self.wait(rf"^status {status}$")
        if outcome is not None:
            self.wait(rf"^outcome {outcome}:")
            self.wait(r"^left 0 bytes")
        self.restored()

    def restored(self, first_line=True):
        modes = []
        for name in ("before", "after"):
            with open(os.path.join(self.folder, name), encoding="ascii") as file:
                modes.append(file.read())
        check(modes[0] == modes[1], f"terminal modes changed: {modes}")
        check(self.tmux("display", "-p", "#{alternate_on} #{cursor_flag} #{keypad_cursor_flag}").split() ==
              ["0", "1", "0"], "alternate screen, cursor or keypad mode left on")
        if first_line:
            self.wait(r"^BEFORE", "what was on the screen before")
