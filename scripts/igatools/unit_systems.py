"""The sets of units that igasolve knows by name (--unit-system)."""
from dataclasses import dataclass

# Powers of mass, length and time.
MEASURES = {"length": (0, 1, 0), "time": (0, 0, 1), "speed": (0, 1, -1), "acceleration": (0, 1, -2), "force": (1, 1, -2),
            "stress": (1, -1, -2), "energy": (1, 2, -2), "mass": (1, 0, 0), "density": (1, -3, 0), "frequency": (0, 0, -1)}

@dataclass(frozen=True)
class UnitSystem:
    """As igasolve's --unit-system names it; units of mass, length and time in SI, and what others are called."""
    name: str
    mass: float
    length: float
    time: float
    symbols: dict

    def unit(self, measure):
        """Of a measure, in SI."""
        m, l, t = MEASURES[measure]
        return self.mass**m * self.length**l * self.time**t

    def symbol(self, measure):
        return self.symbols[measure]


def symbols(mass, length, time, frequency, force, stress, energy):
    return {"mass": mass, "length": length, "time": time, "frequency": frequency, "speed": f"{length}/{time}",
            "acceleration": f"{length}/{time}²", "density": f"{mass}/{length}³", "force": force, "stress": stress, "energy": energy}


SYSTEMS = {system.name: system for system in (
    UnitSystem("t-mm-s", 1e3, 1e-3, 1.0, symbols("t", "mm", "s", "Hz", "N", "MPa", "mJ")),
    UnitSystem("kg-mm-ms", 1.0, 1e-3, 1e-3, symbols("kg", "mm", "ms", "kHz", "kN", "GPa", "J")),
    UnitSystem("SI", 1.0, 1.0, 1.0, symbols("kg", "m", "s", "Hz", "N", "Pa", "J")))}
