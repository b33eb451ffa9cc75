"""Reads a run's frames through the HDF5 library that the program itself uses: no module of Python's is needed."""
import ctypes, os, re, subprocess


class FrameReader:
    def __init__(self, sunder):
        listed = subprocess.run(["ldd", sunder], capture_output=True, text=True).stdout
        self.h5 = ctypes.CDLL(re.search(r"=> (\S*libhdf5\S*)", listed).group(1))
        self.h5.H5open()
        whole = ctypes.c_int64
        for name, result, arguments in (("H5Fopen", whole, [ctypes.c_char_p, ctypes.c_uint, whole]), ("H5Dopen2", whole, [whole, ctypes.c_char_p, whole]),
                                        ("H5Dget_space", whole, [whole]), ("H5Sget_simple_extent_npoints", whole, [whole]),
                                        ("H5Dread", ctypes.c_int, [whole] * 5 + [ctypes.c_void_p]), ("H5Dclose", ctypes.c_int, [whole]),
                                        ("H5Sclose", ctypes.c_int, [whole]), ("H5Fclose", ctypes.c_int, [whole])):
            function = getattr(self.h5, name)
            function.restype, function.argtypes = result, arguments
        self.double = whole.in_dll(self.h5, "H5T_NATIVE_DOUBLE_g").value

    def read(self, folder, frame, path):
        h5 = self.h5
        file = h5.H5Fopen(os.path.join(folder, "frames", f"{frame:06d}.hdf").encode(), 0, 0)
        data = h5.H5Dopen2(file, path.encode(), 0)
        space = h5.H5Dget_space(data)
        values = (ctypes.c_double * h5.H5Sget_simple_extent_npoints(space))()
        if min(file, data, space, h5.H5Dread(data, self.double, 0, 0, 0, values)) < 0:
            raise OSError(f"{folder}: frame {frame}: {path}")
        h5.H5Sclose(space), h5.H5Dclose(data), h5.H5Fclose(file)
        return list(values)
