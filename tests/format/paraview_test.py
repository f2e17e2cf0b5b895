#!/usr/bin/python3
"""ParaView opens the viewer files without asking anything, steps through them, and shows the numbers of the results file.
usage: paraview_test.py SYNTHETIC_RESULTS_TOOL FOLDER [RESULTS.h5 ...]; exit code 77 where ParaView is missing"""
import subprocess
import sys
import shutil
from pathlib import Path

import h5py
import numpy as np

try:
    from paraview import servermanager, simple
    from vtkmodules.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"skipped: no ParaView for {sys.executable} ({error}); apt-get install python3-paraview")
    sys.exit(77)


def opened(path):
    """The reader that a double click starts. A dialogue would come up where several readers may take the file."""
    factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    factory.UpdateAvailableReaders()
    readers = factory.GetReaders(str(path), servermanager.ActiveConnection.Session)
    assert readers.GetLength() == 3, f"{path}: ParaView would ask which reader to take"  # group, name, label of one
    return simple.OpenDataFile(str(path))


def arrays_of(attributes):
    return {attributes.GetArrayName(i): vtk_to_numpy(attributes.GetArray(i)) for i in range(attributes.GetNumberOfArrays())}


def compare(results):
    with h5py.File(results) as file:
        surface = {name: item[()] for name, item in file["surface"].items()}
        frequencies = file["frequencies"][()] if "frequencies" in file else None
    reader = opened(results.with_suffix(".pvd"))
    np.testing.assert_array_equal(reader.TimestepValues, surface["steps"])
    fields = [name for name in ("displacement", "von_mises", "stress", "strain", "temperature", "heat_flux",
                               "von_mises_error", "safety_factor") if name in surface]
    for step, time in enumerate(reader.TimestepValues):
        reader.UpdatePipeline(time)
        data = servermanager.Fetch(reader)
        assert data.GetClassName() == "vtkPolyData", data.GetClassName()
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), surface["vertices"])
        triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        np.testing.assert_array_equal(triangles, surface["triangles"])
        np.testing.assert_array_equal(vtk_to_numpy(data.GetCellData().GetArray("region")), surface["region"])
        numbers = {name: float(value[0]) for name, value in arrays_of(data.GetFieldData()).items()}
        scale = numbers.get("scale", 1.0)
        if frequencies is not None:
            assert numbers["frequency"] == frequencies[step] and numbers["mode"] == step + 1, numbers
            diagonal = np.linalg.norm(np.ptp(surface["vertices"], axis=0))
            largest = np.linalg.norm(surface["displacement"][step], axis=1).max()
            np.testing.assert_allclose(scale * largest, diagonal / 20, rtol=1e-12)
        shown = arrays_of(data.GetPointData())
        assert sorted(shown) == sorted(fields), sorted(shown)
        for name in fields:
            expected = scale * surface[name][step]
            np.testing.assert_allclose(shown[name], expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())
    # What a user does next: the deformed shape.
    warped = simple.WarpByVector(Input=reader, Vectors=["POINTS", "displacement"])
    warped.UpdatePipeline(reader.TimestepValues[-1])
    assert servermanager.Fetch(warped).GetNumberOfPoints() == len(surface["vertices"])
    single = next((results.parent / (results.stem + "_vtp")).glob("*.vtp"))
    opened(single).UpdatePipeline()
    print(f"{results}: {len(reader.TimestepValues)} steps, {len(surface['vertices'])} vertices, {', '.join(fields)}")


def main():
    tool, folder = Path(sys.argv[1]), Path(sys.argv[2])
    given = [Path(argument) for argument in sys.argv[3:]]
    for path in given:
        compare(path)
    # A name with everything that XML and shells dislike.
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for kind in ("eigen", "static", "buckling", "full"):
        path = folder / f"Teil <1> & 'größe' {kind}.h5"
        subprocess.run([tool, "write", kind, path], check=True)
        compare(path)


if __name__ == "__main__":
    main()
