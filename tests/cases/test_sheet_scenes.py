#!/usr/bin/env python3
"""The figures of the sheet paper: what breaks, where, and whether it is the same on both sides (METHOD.md section 7).

Usage: test_sheet_scenes.py SUNDER [NAME...]   Each run works in a scratch folder and with a ledger of its own, in f64.
Frames are read through the HDF5 library that the program itself uses. Bonds are told by their middles at rest.
"""
import json, math, os, shutil, subprocess

import harness
from frame_reader import FrameReader
from harness import SOURCE, SUNDER, check, run_tests


class Bonds(FrameReader):
    def read(self, folder, frame, name):
        return super().read(folder, frame, f"/sheet/{name}")


library = Bonds(SUNDER)


class Run:
    """One finished run: places by particle, bonds, which are broken when."""

    def __init__(self, folder, summary):
        self.folder, self.summary = folder, summary
        flat = library.read(folder, 0, "position")
        self.rest = [tuple(flat[i:i + 3]) for i in range(0, len(flat), 3)]
        pairs = [int(v) for v in library.read(folder, 0, "bonds")]
        self.bonds = list(zip(pairs[::2], pairs[1::2]))
        self.cut = library.read(folder, 0, "bond_broken")

    def places(self, frame):
        flat = library.read(self.folder, frame, "position")
        return [tuple(flat[i:i + 3]) for i in range(0, len(flat), 3)]

    def broken(self, frame):
        """Middles and lengths along the axes of bonds broken since the start: what a mirror can be held to."""
        now = library.read(self.folder, frame, "bond_broken")
        found = []
        for (i, j), flag, before in zip(self.bonds, now, self.cut):
            if flag and not before:
                a, b = self.rest[i], self.rest[j]
                found.append((0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), a[0] - b[0], a[1] - b[1]))
        return found

    @property
    def last(self):
        return self.summary["frames"]


class Box(harness.Box):
    def run(self, scene, label="", **settings):
        out = self.path(f"{scene}{label}{len(os.listdir(self.folder))}")
        chosen = [part for key, value in settings.items() for part in ("--set", f"{key.replace('__', '.')}={value}")]
        code, summary, err = super().run(os.path.join(SOURCE, "scenes/sheet", scene + ".lua"), "--precision", "f64", "--out", out,
                                         "--checkpoint-every", "0", *chosen)
        if code:
            raise RuntimeError(f"{scene}: {err[-500:]}")
        return Run(out, summary)


def mirror_difference(bonds, axis):
    """Share of broken bonds whose mirror image is whole. axis 0: x ↦ −x."""
    def key(bond, flip):
        mx, my, dx, dy = bond
        if flip:
            (mx, dx) = (-mx, -dx) if axis == 0 else (mx, dx)
            (my, dy) = (-my, -dy) if axis == 1 else (my, dy)
        if dx < -1e-9 or (abs(dx) < 1e-9 and dy < 0):
            dx, dy = -dx, -dy
        return round(mx, 6) + 0.0, round(my, 6) + 0.0, round(dx, 6) + 0.0, round(dy, 6) + 0.0
    here = {key(b, False) for b in bonds}
    there = {key(b, True) for b in bonds}
    return len(here ^ there) / max(1, len(here | there))


def both_ways(scene, axis, **settings):
    """Dry is its own mirror image, wet is not."""
    with Box() as box:
        for variant in ("dry", "wet"):
            run = box.run(scene, variant=variant, **settings)
            bonds = run.broken(run.last)
            difference = mirror_difference(bonds, axis)
            print(f"  {scene} {variant}: {len(bonds)} bonds broken, mirror difference {difference:.3f}")
            check(len(bonds) > 40, f"{scene} {variant}: it breaks")
            if variant == "dry":
                check(difference < 0.05, f"{scene} dry: symmetric within 5 %: {difference}")
            else:
                check(difference > 0.25, f"{scene} wet: not symmetric: {difference}")


def test_foil():
    both_ways("foil", 0)


def test_seaweed():
    both_ways("seaweed", 0)


def test_paper_towel():
    both_ways("paper_towel", 0)


def test_rubber():
    both_ways("rubber", 0, ripple=0)


def test_crack_path():
    with Box() as box:
        dry, wet = (box.run("crack_path", variant=v) for v in ("dry", "wet"))
        difference = mirror_difference(dry.broken(dry.last), 1)
        print(f"  dry: mirror difference {difference:.3f}; wet {mirror_difference(wet.broken(wet.last), 1):.3f}")
        check(difference < 0.05, f"dry: symmetric: {difference}")
        check(mirror_difference(wet.broken(wet.last), 1) > 0.25, "wet: not symmetric")
        # The first crack of each: what is broken once it has gone half of its way.
        for name, run in (("dry", dry), ("wet", wet)):
            tips = []
            for frame in range(0, run.last + 1, 2):
                bonds = run.broken(frame)
                if bonds:
                    tips.append((frame, max(b[0] for b in bonds)))
            frame = next(f for f, x in tips if x > 0.02)
            ahead = [b[1] for b in run.broken(frame) if b[0] > -0.12]
            mean = sum(ahead) / len(ahead)
            print(f"  {name}: mean height of the crack before the first source: {mean:.4f}")
            if name == "dry":
                check(abs(mean) < 0.01, f"dry: straight: {mean}")
            else:
                check(mean > 0.02, f"wet: turns towards the source above it: {mean}")


def test_nonlocal():
    """Fig. 11: with the larger reach the crack is slower, and the sheet stiffer while it runs: it stores more at the same stretch. (Before the
    crack moves, calibrated sheets are equally stiff whatever their reach: E is what was asked for.)"""
    dx, arrival, stored, before = 0.04, [], [], []
    reaches = (1.5, 3.0, 5.1)
    with Box() as box:
        for R in reaches:
            run = box.run("nonlocal", label=f"r{R}", dx=dx, R=R * dx)
            tips = [(f, max((b[0] for b in run.broken(f) if abs(b[1]) < 2.5 * dx), default=-1)) for f in range(0, run.last + 1, 2)]
            arrival.append(next(f for f, x in tips if x > 0.4))
        for R in reaches:
            stored.append(box.run("nonlocal", label=f"e{R}", dx=dx, R=R * dx, duration=arrival[0] / 50).summary["energy"]["elastic"])
            before.append(box.run("nonlocal", label=f"b{R}", dx=dx, R=R * dx, strain_rate=0.002).summary["energy"]["elastic"])
    print("  frame at which the crack passes x = 0.4:", arrival, " energy stored then:", [f"{e:.4g}" for e in stored], " long before:",
          [f"{e:.4g}" for e in before])
    check(arrival[0] < arrival[1] < arrival[2], f"larger R is slower: {arrival}")
    check(stored[0] < stored[1] < stored[2], f"larger R is stiffer while it cracks: {stored}")
    check(max(before) / min(before) < 1.03, f"and calibrated before: {before}")


def amplitude(run, frame, region):
    places = run.places(frame)
    heights = [places[i][2] for i, x in enumerate(run.rest) if region(x)]
    return math.sqrt(sum(h * h for h in heights) / len(heights))


def test_wrinkles():
    """Rubber wrinkles along its slit: from 1e-4 spacings the amplitude grows over 100 times under tension with a slit, under 10 times without
    tension."""
    with Box() as box:
        def near(x):
            return abs(x[0]) < 0.3 and x[1] > 0.2
        growth = {}
        for name, settings in (("slit", {}), ("slack", {"pull": 0})):
            run = box.run("rubber", label=name, duration=2, **settings)
            start = amplitude(run, 0, near)
            growth[name] = max(amplitude(run, f, near) for f in range(1, run.last + 1)) / start
        print("  growth of the amplitude:", {k: f"{v:.3g}" for k, v in growth.items()})
        check(growth["slit"] > 100, f"with tension: {growth}")
        check(growth["slack"] < 10, f"without tension: {growth}")


def test_stretch_and_shear():
    with Box() as box:
        run = box.run("stretch", dx=0.04)
        places = run.places(run.last)
        check(run.summary["bonds"]["broken"] == 0, "stretch: nothing breaks")
        waist = max(places[i][1] for i, x in enumerate(run.rest) if abs(x[0]) < 0.1)
        check(waist < 0.93, f"stretch: the sheet narrows: {waist}")
        run = box.run("shear", dx=0.04)
        middle = lambda x: abs(x[0]) < 0.7
        start, end = amplitude(run, 0, middle), amplitude(run, run.last, middle)
        print(f"  shear: folds grow from {start:.2g} to {end:.2g}")
        check(end > 20 * start and end > 0.005, f"shear: it folds: {start} {end}")


def test_seeds():
    """Sprays depend on the seed alone: the same at any number of threads, another with another seed."""
    with Box() as box:
        first, again, other = (box.run("rubber", label=str(k), variant="wet", duration=0.2, seed=seed) for k, seed in enumerate((1, 1, 2)))
        theta = [library.read(r.folder, r.last, "diffused") for r in (first, again, other)]
        check(theta[0] == theta[1] and max(theta[0]) > 0, "the same seed sprays the same places")
        check(theta[0] != theta[2], "another seed sprays others")


def test_resume_and_files():
    """A resumed run goes on with the same bits; a frame holds what the file format promises; explain and the summary say what runs."""
    scene = os.path.join(SOURCE, "scenes/sheet/rubber.lua")
    settings = ["--set", "variant=wet", "--set", "pull=0.5", "--json", "--quiet"]
    with Box() as box:
        code, out, err = box.call("run", scene, "--frames", "24", "--threads", "2", *settings)
        whole = json.loads(out)
        check(code == 0 and whole["bonds"]["broken"] > 30, f"the whole run breaks: {err}")
        code, out, err = box.call("run", scene, "--frames", "13", "--threads", "1", *settings)
        part = json.loads(out)
        code, out, err = box.call("run", "--resume", part["run_id"], "--frames", "11", "--json", "--quiet")
        check(code == 0, f"resume: {err}")
        again = json.loads(out)
        check(again["state_hash"] == whole["state_hash"] and again["bonds"] == whole["bonds"] and again["steps"] == whole["steps"], "resumed: same bits")
        n, m = whole["particles"], whole["bonds"]["total"]
        first, last = whole["out"], whole["frames"]
        sizes = {name: len(library.read(first, last, name)) for name in ("position", "velocity", "id", "diffused", "broken", "bond_broken")}
        check(sizes == {"position": 3 * n, "velocity": 3 * n, "id": n, "diffused": n, "broken": n, "bond_broken": m}, f"frame: {sizes}")
        check(len(library.read(first, 0, "bonds")) == 2 * m, "bonds in frame 0")
        check(sum(library.read(first, last, "bond_broken")) == whole["bonds"]["broken"], "bond_broken agrees with the summary")
        listed = subprocess.run(["h5ls", f"{first}/frames/{last:06d}.hdf/sheet"], capture_output=True, text=True) if shutil.which("h5ls") else None
        check(listed is None or ("bond_broken" in listed.stdout and "bonds" not in listed.stdout), "bonds stand in frame 0 alone")
        code, out, err = box.call("explain", scene, "--set", "variant=wet", "--json")
        plan = json.loads(out)
        check(code == 0 and {"rubber", "fracture", "diffusion", "swelling", "softening", "boundary"} == set(plan["effects_on"]), f"explain: {plan['effects_on']}")
        check("rubber.bonds" in plan["stages"] and "diffusion.after" in plan["stages"] and "boundary.advance" in plan["stages"], f"stages: {plan['stages']}")
        check(plan["step_limits"]["diffusion"] > plan["step_limits"]["rubber"] > 0, f"limits: {plan['step_limits']}")


def test_wrong_scenes():
    """What is wrong names file, line, key and the nearest right word."""
    cases = {
        "lattice = 'hexagnal'": "did you mean 'hexagonal'", "latice = 'square'": "did you mean 'lattice'", "notches = { { from = {0,0,0} } }": "from and to, or a shape",
        "sources = { { rate = 1 } }": "a material with diffusion", "radius = 9": "from 1.2 to 6", "thickness = -1": "above 0",
    }
    with Box() as box:
        for line, expected in cases.items():
            path = box.path("scene.lua")
            with open(path, "w") as file:
                file.write('local s = require "sunder"\nreturn s.scene { dx = 0.1, duration = 1, sheets = { { shape = s.disk { radius = 1 },\n'
                           + ("" if "thickness" in line else "thickness = 0.1, ") + 'material = { density = 1, linear = { E = 1 } },\n' + line + " } } }\n")
            code, out, err = box.call("check", path)
            check(code == 2 and expected in err and "scene.lua:" in err, f"{line}: {code} {err}")
        for material, expected in (("linear = { E = 1 }, elastic = { E = 1 }", "an effect of sheets"), ("elastic = { E = 1 }", "an effect of sheets"),
                                   ("linear = { E = 1 }, swelling = 0.1", "diffusion"), ("fracture = 1", "linear")):
            with open(path, "w") as file:
                file.write('local s = require "sunder"\nreturn s.scene { dx = 0.1, duration = 1, sheets = { { shape = s.disk { radius = 1 }, thickness = 0.1,\n'
                           "material = { density = 1, " + material + " } } } }\n")
            code, out, err = box.call("check", path)
            check(code == 2 and expected in err, f"{material}: {code} {err}")


def test_shapes_of_sheets():
    """Rectangles, disks, polygons with a bay, holes and surfaces hold as many particles as their areas say."""
    shapes = {
        "s.rectangle { size = { 2, 1 } }": 2.0, "s.disk { radius = 0.5 }": math.pi / 4, "s.polygon { {0,0}, {2,0}, {2,2}, {1,1}, {0,2} }": 3.0,
        "s.rectangle { size = { 2, 1 } } - s.disk { radius = 0.3 }": 2 - math.pi * 0.09,
    }
    with Box() as box:
        path = box.path("scene.lua")
        for lattice, per in (("square", 1.0), ("hexagonal", math.sqrt(0.75)), ("scattered", 1.0)):
            for shape, area in list(shapes.items()) + ([("s.sphere { radius = 0.5 }, surface = true", math.pi)] if lattice == "scattered" else []):
                with open(path, "w") as file:
                    file.write('local s = require "sunder"\nreturn s.scene { duration = 1, sheets = { { shape = ' + shape + f", spacing = 0.04, lattice = '{lattice}',\n"
                               "radius = 2.1, thickness = 0.1, material = { density = 1, linear = { E = 1 } } } } }\n")
                code, out, err = box.call("run", path, "--frames", "0", "--json", "--quiet")
                count = json.loads(out)["particles"] if code == 0 else -1
                expected = area / (0.04 ** 2 * per)
                check(abs(count / expected - 1) < (0.15 if lattice == "scattered" else 0.05), f"{lattice} {shape}: {count} for {expected:.0f}: {err}")


run_tests(globals())
