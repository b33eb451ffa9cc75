"""What the tests of this folder share: the program that is tested, checks and their count, scratch folders, and the order of a test file.

A file's functions named test_… are its tests; arguments after the program choose some, with or without that beginning.
"""
import glob, json, os, shutil, sqlite3, subprocess, sys, tempfile, time, traceback

SUNDER = os.path.abspath(sys.argv[1])
SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ENDLESS = ["--frames", "1000000"]  # no machine comes to the end of it within a test: who is to be stopped under way is under way
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

    def stop_after(self, number, frame, *arguments):
        """Starts an endless run, sends it a signal when it has written a frame (some more may be there by then), and returns its exit code and
        its folder."""
        before = self.rows("SELECT count(*) FROM runs")[0][0] if os.path.exists(self.db) else 0
        process = self.start_run(*arguments, *ENDLESS)
        folder = None
        while process.poll() is None and not (folder and frame in frames_of(folder)):
            time.sleep(0.005)
            if folder is None:
                folder = self.output_of(before)
        process.send_signal(number)
        process.communicate()
        return process.returncode, folder

    def output_of(self, place):
        """The folder of the run at this place of the ledger; None as long as there is none."""
        try:
            found = self.rows("SELECT output FROM runs ORDER BY run LIMIT 1 OFFSET ?", place)
        except sqlite3.OperationalError:  # the ledger is being made
            return None
        return found[0][0] if found else None


def frames_of(folder):
    """Numbers of the frames that a run has written."""
    return [int(os.path.basename(f)[:6]) for f in sorted(glob.glob(os.path.join(folder, "frames", "[0-9]*.hdf")))]


def checkpoints_of(folder):
    """Numbers of the frames that a run can go on from."""
    return sorted(int(f[-10:-4]) for f in glob.glob(os.path.join(folder, "checkpoint-*.hdf")))


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
