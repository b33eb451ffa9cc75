# pvpython paraview_check.py FOLDER: opens the run that make_run wrote and checks times, points and arrays of both views.
import os
import sys

from paraview import servermanager
from paraview.simple import Delete, OpenDataFile

failures = 0


def check(condition, text):
    global failures
    if not condition:
        failures += 1
        print("  failed:", text)


def near(a, b):
    return abs(a - b) <= 1e-6 * max(1.0, abs(b))


def open_series(path):
    reader = OpenDataFile(path)
    reader.UpdatePipelineInformation()
    return reader, list(reader.TimestepValues)


def arrays_of(reader):
    data = reader.PointData
    return {data.GetArray(i).Name: data.GetArray(i) for i in range(data.NumberOfArrays)}


def check_solid(folder):
    reader, times = open_series(os.path.join(folder, "frames", "frames.hdf.series"))
    check(times == [0.0, 0.125, 0.25], f"times are {times}")
    for frame, time in zip((0, 3, 6), times):
        reader.UpdatePipeline(time)
        grid = servermanager.Fetch(reader)
        check(grid.GetNumberOfPoints() == 20000, f"{grid.GetNumberOfPoints()} points")
        check(grid.GetNumberOfCells() == 20000, f"{grid.GetNumberOfCells()} cells")
        check(grid.GetCellType(19999) == 1, "cells are vertices")
        check(grid.GetCell(19999).GetPointId(0) == 19999, "cell i is point i")
        point = grid.GetPoint(7)
        check(all(near(x, 7 * (k + 1) + frame) for k, x in enumerate(point)), f"point 7 of frame {frame} is {point}")
        found = {name: array.GetNumberOfComponents() for name, array in arrays_of(reader).items()}
        expected = {"velocity": 3, "id": 1, "damage": 1, "deformation_gradient": 9}
        check(found == expected, f"arrays are {found}")
        data = grid.GetPointData()
        check(near(data.GetArray("damage").GetTuple1(10000), 0.5), "damage of particle 10000")
        check(data.GetArray("id").GetTuple1(19999) == 19999, "id of the last particle")
        check(near(data.GetArray("deformation_gradient").GetComponent(0, 8), 1.0), "F of particle 0")
    Delete(reader)  # before the end of the program, when HDF5 is gone and complains


def check_sheet(folder):
    reader, times = open_series(os.path.join(folder, "frames", "sheet", "frames.hdf.series"))
    check(times == [0.0, 0.125, 0.25], f"times of the sheet are {times}")
    reader.UpdatePipeline(times[1])
    grid = servermanager.Fetch(reader)
    check(grid.GetNumberOfPoints() == 300, f"{grid.GetNumberOfPoints()} points in the sheet")
    check(grid.GetPoint(299) == (299.0, 100.0, 0.0), f"the sheet's last point is {grid.GetPoint(299)}")
    check(list(arrays_of(reader)) == ["diffused"], f"the sheet's arrays are {list(arrays_of(reader))}")
    check(near(grid.GetPointData().GetArray("diffused").GetTuple1(1), 0.5), "diffused of particle 1")
    Delete(reader)


check_solid(sys.argv[1])
check_sheet(sys.argv[1])
print("ok" if failures == 0 else f"{failures} failed")
sys.exit(1 if failures else 0)
