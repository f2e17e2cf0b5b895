"""Explicit runs that are stopped and compared, for the tests in Python."""
import subprocess

import h5py


def start(command):
    """A run at work: its first steps are done."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    lines = ""
    while "stepping:" not in lines:
        line = process.stderr.readline()
        if not line:
            raise AssertionError("the run ended before it stepped: " + lines)
        lines += line
    return process


def series(path):
    """Every time series of a results file, by its name."""
    data = {}
    with h5py.File(path) as file:
        file["time_series"].visititems(
            lambda name, item: data.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return data
