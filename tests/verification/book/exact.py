"""Exact solutions that several cases use."""
import numpy as np
from scipy.optimize import brentq
from scipy.special import spherical_jn, spherical_yn


def roots(function, low, high, steps=4000):
    """Where a function, defined between low and high, changes sign without a pole; found in `steps` intervals."""
    at = np.linspace(low, high, steps + 1)
    values = np.array([function(x) for x in at])
    found = []
    for k in np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0):
        root = brentq(function, at[k], at[k + 1], xtol=1e-14, rtol=1e-14)
        if abs(function(root)) <= min(abs(values[k]), abs(values[k + 1])):
            found.append(root)
    return found


def wave_speeds(E, nu, rho):
    """Of pressure and shear waves."""
    mu = E / (2 * (1 + nu))
    return np.sqrt((2 * mu * nu / (1 - 2 * nu) + 2 * mu) / rho), np.sqrt(mu / rho)


def lamb(k, thickness, cp, cs, antisymmetric):
    """The lowest ω of a wave of wave number k in a plate with free faces (Rayleigh and Lamb): of bending, or of stretching."""
    h = thickness / 2

    def equation(w):
        p, q = np.emath.sqrt((w / cp)**2 - k**2), np.emath.sqrt((w / cs)**2 - k**2)
        # Multiplied out, and divided by what is imaginary or zero together: real and without poles.
        cosine = lambda z: np.cos(z * h)  # noqa: E731
        sine = lambda z: np.sin(z * h) / z if abs(z) > 1e-12 else h + 0 * z  # noqa: E731
        if antisymmetric:
            value = (q**2 - k**2)**2 * cosine(q) * sine(p) + 4 * k**2 * q**2 * sine(q) * cosine(p)
        else:
            value = (q**2 - k**2)**2 * sine(q) * cosine(p) + 4 * k**2 * p**2 * cosine(q) * sine(p)
        return float(np.real(value))

    # q = 0, ω = cs k, solves the equation of bending without being a wave: the sine is divided by q there.
    return roots(equation, 1e-3 * cs * k, 3 * cs * k)[0]


def hollow_sphere_radial(inner, outer, E, nu, rho, count):
    """Frequencies (1/time) of radial vibration of a sphere with free faces; inner = 0: solid."""
    cp, cs = wave_speeds(E, nu, rho)
    mu, lam = cs**2 * rho, (cp**2 - 2 * cs**2) * rho

    def stress(radial, r, k):
        """σ_rr of u = z(k r): (λ + 2 μ) u' + 2 λ u / r."""
        value, slope = radial(1, k * r), radial(1, k * r, derivative=True)
        return (lam + 2 * mu) * k * slope + 2 * lam * value / r

    def equation(k):
        if inner == 0:
            return stress(spherical_jn, outer, k)
        return (stress(spherical_jn, inner, k) * stress(spherical_yn, outer, k)
                - stress(spherical_jn, outer, k) * stress(spherical_yn, inner, k))
    high = (count + 2) * np.pi / (outer - inner)
    return [k * cp / (2 * np.pi) for k in roots(equation, 0.05 / outer, high)[:count]]


def sphere_torsional(order, count):
    """ω a / c_s of the torsional modes of a free solid sphere, l = order (Lamb 1882; Eringen & Suhubi 1975)."""
    return roots(lambda x: (order - 1) * spherical_jn(order, x) - x * spherical_jn(order + 1, x), 0.5, 6 + 4 * count)[:count]


def sphere_spheroidal(order, nu, count):
    """ω a / c_s of the spheroidal modes of a free solid sphere, l = order >= 1: σ_rr = σ_rθ = 0 of the potentials
    j_l(h r) P_l and r j_l(k r) P_l (Lamb 1882; Eringen & Suhubi 1975)."""
    n, ratio = order, np.sqrt((1 - 2 * nu) / (2 * (1 - nu)))  # c_s / c_p

    def equation(y):
        x = ratio * y
        jx, jx1, jy, jy1 = spherical_jn(n, x), spherical_jn(n + 1, x), spherical_jn(n, y), spherical_jn(n + 1, y)
        a = (n * n - n - y * y / 2) * jx + 2 * x * jx1          # σ_rr / 2 μ of the first, times r²
        b = n * (n + 1) * ((n - 1) * jy - y * jy1)              # σ_rr / 2 μ of the second
        c = (n - 1) * jx - x * jx1                              # σ_rθ / 2 μ of the first
        d = (n * n - 1 - y * y / 2) * jy + y * jy1              # σ_rθ / 2 μ of the second
        return a * d - b * c
    return roots(equation, 0.5, 6 + 4 * count)[:count]


def torsion_constant(width, height):
    """J of a rectangle: twist per length = M / (G J) (Saint-Venant's series)."""
    a, b = max(width, height), min(width, height)
    n = np.arange(1, 200, 2)
    return a * b**3 / 3 * (1 - 192 * b / (np.pi**5 * a) * (np.tanh(n * np.pi * a / (2 * b)) / n**5).sum())
