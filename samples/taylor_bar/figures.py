#!/usr/bin/python3
"""What is asked of a Taylor bar, from the results of igasolve explicit:  samples/taylor_bar/figures.py taylor_0.8mm.h5 …

length: of the bar at the end, between its lowest and its highest point; radius: of the foot's rim, largest and smallest;
plastic strain: largest equivalent one at the end, over the quadrature points.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from igatools import iga_results  # noqa: E402


def figures(results):
    last, energy = results.fields(-1), results.series("energy")
    rest = last.mesh["bar/vertices"]
    now = rest + last["bar/displacement"]
    radius = np.hypot(now[:, 0], now[:, 1])
    from_axis = np.hypot(rest[:, 0], rest[:, 1])
    rim = (rest[:, 2] < rest[:, 2].min() + 1e-6) & (from_axis > 0.998 * from_axis.max())
    return {"end": float(results["/time_series/time"][-1]), "length": float(np.ptp(now[:, 2])),
            "radius": float(radius.max()), "smallest_rim_radius": float(radius[rim].min()),
            "largest_plastic_strain": float(last["bar/point_plastic_strain"].max()),
            "least_volume_ratio": float(results.series("body/bar")["min_volume_ratio"].min()),
            "internal_over_start": float(energy["internal"][-1] / energy["kinetic"][0]),
            "kinetic_at_start": float(energy["kinetic"][0]),
            "energy_error": float(np.abs(results["/time_series/energy_error"]).max()),
            "lowest_point": float(now[:, 2].min())}


if __name__ == "__main__":
    for file in sys.argv[1:]:
        print(file)
        for name, value in figures(iga_results.read(file)).items():
            print(f"  {name:<24}{value:.6g}")
