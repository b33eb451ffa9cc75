"""Presses every action of the workbench at least once, in the program itself over a small run in a terminal of its own, and reads its effect from the
screen, the ledger or a file. The list of actions is the program's (`sunder help actions --json`): one that no case covers is a failure.

Cases are in actions/, a file a screen: a function decorated with @covers("name" …) gets a Bench (see bench.py).

Usage: test_actions.py SUNDER SCENES [name ...]   Exit codes: 0 passed, 1 failed, 77 skipped (no tmux).
"""
import concurrent.futures
import importlib
import json
import os
import subprocess
import sys
import traceback

import bench
from terminal import Failure

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "actions")


def load_cases():
    """All cases by the names of the actions they cover."""
    sys.path.insert(0, FOLDER)
    for file in sorted(os.listdir(FOLDER)):
        if file.endswith(".py"):
            importlib.import_module(file[:-3])
    return bench.CASES


def run(case):
    try:
        with bench.Bench(**case.options) as s:
            case.function(s)
        return None
    except Failure as failure:
        return str(failure)
    except Exception as error:  # whatever it is, it is this case's failure
        traceback.print_exc()
        return repr(error)


def main():
    bench.use_arguments(__doc__)
    cases = load_cases()
    listed = json.loads(subprocess.run([bench.SUNDER, "help", "actions", "--json"], capture_output=True, text=True, check=True).stdout)
    names = [action["name"] for action in listed]
    wanted = sys.argv[3:] or names
    failures = 0
    for name in sorted(set(cases) - set(names)):
        print(f"FAIL {name}: a case for an action that the program has not")
        failures += 1
    for name in wanted:
        if name not in cases:
            print(f"FAIL {name}: no case presses it")
            failures += 1
    chosen = list({id(case): case for name in wanted for case in cases.get(name, [])}.values())
    with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("SUNDER_JOBS", "2"))) as pool:
        for case, problem in zip(chosen, pool.map(run, chosen)):
            label = " ".join(case.names)
            print(f"FAIL {label}: {problem}" if problem else f"ok   {label}", flush=True)
            failures += problem is not None
    print(f"{len(wanted)} actions, {len(chosen)} cases, {failures} failed")
    return 1 if failures or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())
