"""What the open workbench costs the simulation, and how soon it answers a key.

Runs a scene without a screen (`sunder run --quiet`) and with the workbench open on it in a pseudo-terminal, in turn, and compares steps per second of the
whole run's wall time, and of the steps' own; while the workbench is open, keys are pressed and their answers timed (help opens and closes). --reading N:
instead, keys while the Compare screen reads frames of N particles. --scenes: instead, keys while the Scenes screen looks at one scene after the other.
Exit code 1 when the workbench keeps less than 0.95 of the steps per second, or the median answer takes 50 ms.

Usage: bench_workbench.py SUNDER SCENE [--rounds N] [--frames N] [--set KEY=VALUE]… [--width N] [--height N] [--reading N | --scenes] [--json]
"""
import argparse
import fcntl
import json
import os
import pty
import select
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time


def speed(folder):
    """Steps per second of wall time, and of the time in steps alone, of the run in a folder."""
    with open(os.path.join(folder, "result.json"), encoding="utf-8") as file:
        result = json.load(file)
    return result["steps"] / result["wall_s"], result["steps"] / result["step_wall_s"]


class Terminal:
    """The program on a bare pseudo-terminal."""

    def __init__(self, arguments, width, height, environment):
        self.pid, self.descriptor = pty.fork()
        if self.pid == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", height, width, 0, 0))
            os.execve(arguments[0], arguments, environment)
        self.open = True

    def read(self, seconds):
        """What it has drawn within so long; None when it is gone."""
        ready, _, _ = select.select([self.descriptor], [], [], seconds)
        if not ready:
            return b""
        try:
            return os.read(self.descriptor, 65536) or None
        except OSError:
            return None

    def answer(self, key, sign):
        """Seconds from a key to the first drawing that has the sign; None when the program is gone."""
        seen = b""
        start = time.monotonic()
        os.write(self.descriptor, key)
        while sign not in seen:
            part = self.read(10)
            if part is None or (part == b"" and time.monotonic() - start > 10):
                return None
            seen = (seen + part)[-65536:]
        return time.monotonic() - start


def screen_seconds(pid):
    """Processor time of the screen's own thread, which is the process's first."""
    try:
        with open(f"/proc/{pid}/task/{pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return 0.0


def quiet(o, base, folder, environment):
    subprocess.run([*base, "--out", folder, "--quiet"], env=environment, check=True)
    return speed(folder)


def workbench(o, base, folder, environment):
    """The same run with the workbench open on it; also the answers' delays."""
    terminal = Terminal([*base, "--out", folder, "--tui"], o.width, o.height, environment)
    delays, used, started = [], 0.0, time.monotonic()
    end = time.monotonic() + 1
    while time.monotonic() < end:
        terminal.read(0.1)
    while not os.path.exists(os.path.join(folder, "result.json")):
        delay = terminal.answer(b"?", b"this page")
        if delay is None:
            break
        delays.append(delay)
        used = screen_seconds(terminal.pid) / (time.monotonic() - started)
        for key in (b"?", b""):
            os.write(terminal.descriptor, key)
            end = time.monotonic() + 1.5
            while time.monotonic() < end:
                terminal.read(0.05)
    os.write(terminal.descriptor, b"q")
    while terminal.read(0.5):
        pass
    os.waitpid(terminal.pid, 0)
    return speed(folder), delays, used


def answers(terminal, presses, pause):
    """Delays of keys that come one after the other: the bytes to press, and what the answer has in it (None: anything)."""
    delays = []
    for key, sign in presses:
        while terminal.read(pause):
            pass
        delay = terminal.answer(key, sign)
        if delay is None:
            break
        delays.append(delay)
    return delays


def leave(terminal):
    os.write(terminal.descriptor, b"Q")
    while terminal.read(0.5):
        pass
    os.waitpid(terminal.pid, 0)


def reading(o, base, folder, environment):
    """Keys while Compare reads frames: each time another frame is asked for; then help opens and closes."""
    run = [*base[:3], "--set", f"particles={o.reading}", "--frames", str(o.frames), *base[base.index("--db"):]]
    subprocess.run([*run, "--out", folder, "--quiet"], env=environment, check=True)
    database = base[base.index("--db") + 1]
    terminal = Terminal([base[0], "--db", database], o.width, o.height, environment)
    while terminal.read(1.0):
        pass
    for line in (b":screen compare\r", b":compare.left last\r", b":compare.right last\r"):
        os.write(terminal.descriptor, line)
        while terminal.read(0.3):
            pass
    delays = []
    for i in range(o.frames):
        os.write(terminal.descriptor, b"\033OD")  # another frame is asked for, and read while the key is answered
        delay = terminal.answer(b"?", b"this page")
        if delay is None:
            break
        delays.append(delay)
        os.write(terminal.descriptor, b"?")
        while terminal.read(0.3):
            pass
    leave(terminal)
    return delays


def scenes(o, base, folder, environment):
    """Keys while scenes are read and planned: down the list and up again, faster than previews can follow."""
    terminal = Terminal([base[0], "--db", base[base.index("--db") + 1]], o.width, o.height, environment)
    while terminal.read(1.0):
        pass
    delays = answers(terminal, [(b"\033OA" if i < 12 else b"\033OB", b"\033") for i in range(24)], 0.02)
    leave(terminal)
    return delays


def report(o, result):
    if o.json:
        print(json.dumps(result))
    else:
        for name, value in result.items():
            print(f"{name:24} {value}")


def of_delays(delays):
    return {"keys": len(delays), "key_median_ms": 1e3 * statistics.median(delays) if delays else None, "key_worst_ms": 1e3 * max(delays) if delays else None}


def compare(o, base, base_folder, environment):
    """The same run quietly and in the workbench, in turn."""
    rows, delays, shares = {"quiet": [], "workbench": []}, [], []
    for i in range(o.rounds):
        rows["quiet"].append(quiet(o, base, os.path.join(base_folder, f"quiet{i}"), environment))
        figures, more, used = workbench(o, base, os.path.join(base_folder, f"workbench{i}"), environment)
        rows["workbench"].append(figures)
        delays += more
        shares.append(used)
    share = [statistics.median(row[k] for row in rows["workbench"]) / statistics.median(row[k] for row in rows["quiet"]) for k in (0, 1)]
    report(o, {"share_of_wall": share[0], "share_of_steps": share[1], "quiet_steps_per_s": [row[0] for row in rows["quiet"]],
               "workbench_steps_per_s": [row[0] for row in rows["workbench"]], "screen_share_of_a_core": max(shares), **of_delays(delays)})
    return 0 if share[0] >= 0.95 and (not delays or statistics.median(delays) < 0.05) else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sunder")
    parser.add_argument("scene")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--width", type=int, default=200)
    parser.add_argument("--height", type=int, default=60)
    parser.add_argument("--reading", type=int, default=0)
    parser.add_argument("--scenes", action="store_true")
    parser.add_argument("--json", action="store_true")
    o = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sunder-bench-") as base_folder:
        environment = dict(os.environ, TERM="xterm-256color", LC_ALL="C.UTF-8", XDG_DATA_HOME=base_folder, XDG_CONFIG_HOME=base_folder)
        threads = ["--threads", str(o.threads)] if o.threads else []
        settings = [word for setting in o.set for word in ("--set", setting)]
        base = [os.path.abspath(o.sunder), "run", o.scene, *settings, *threads, "--frames", str(o.frames), "--db", os.path.join(base_folder, "ledger.db")]
        if not o.reading and not o.scenes:
            return compare(o, base, base_folder, environment)
        delays = (reading if o.reading else scenes)(o, base, os.path.join(base_folder, "run"), environment)
        report(o, of_delays(delays))
        return 0 if delays and statistics.median(delays) < 0.05 else 1


if __name__ == "__main__":
    sys.exit(main())
