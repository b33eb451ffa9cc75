"""What the tests of this folder share: the program that is tested, checks and their count, scratch folders, and the order of a test file.

A file's functions named test_… are its tests; arguments after the program choose some, with or without that beginning.
"""
import json, os, shutil, sqlite3, subprocess, sys, tempfile, traceback

SUNDER = os.path.abspath(sys.argv[1])
SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
failures, done = [], 0


def check(condition, text):
    global done
    done += 1
    if not condition:
        failures.append(text)
        print("  failed:", text)


class Box:
    """A scratch folder with its own ledger."""

    def __enter__(self):
        self.folder = tempfile.mkdtemp(prefix="sunder-test-")
        self.db = os.path.join(self.folder, "ledger.db")
        self.environment = dict(os.environ, SUNDER_DB=self.db, XDG_DATA_HOME=os.path.join(self.folder, "data"))
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *arguments, stdin=subprocess.DEVNULL, environment=None):
        return subprocess.Popen([SUNDER, *arguments], env=environment or self.environment, cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, stdin=stdin, text=True)

    def call(self, *arguments, **options):
        """Exit code, standard output, standard error."""
        with self.start(*arguments, **options) as process:
            try:
                out, err = process.communicate(timeout=600)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
        return process.returncode, out, err

    def start_run(self, *arguments):
        return self.start("run", *arguments, "--json", "--quiet")

    def run(self, *arguments):
        """Exit code, summary or None, standard error."""
        code, out, err = self.call("run", *arguments, "--json", "--quiet")
        return code, json.loads(out) if out else None, err

    def rows(self, sql, *values):
        with sqlite3.connect(self.db) as connection:
            return connection.execute(sql, values).fetchall()


def run_tests(names, *arguments):
    """Runs the test_… functions of `names` (a file's globals()) with `arguments`, or without where they take none, and ends the program. A test that
    raises has failed and does not keep the others from running."""
    tests = {name[5:]: test for name, test in names.items() if name.startswith("test_")}
    wanted = [name.removeprefix("test_") for name in sys.argv[2:]]
    for name in set(wanted) - set(tests):
        check(False, f"{name}: no such test")
    for name, test in tests.items():
        if wanted and name not in wanted:
            continue
        before = len(failures)
        try:
            test(*arguments[:test.__code__.co_argcount])
        except Exception as error:  # whatever it is, it is this test's failure
            traceback.print_exc()
            check(False, f"{name}: {error!r}")
        print("ok  " if len(failures) == before else "FAIL", name, flush=True)
    print(f"{done} checks, {len(failures)} failed")
    sys.exit(1 if failures or not done else 0)
