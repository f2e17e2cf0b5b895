"""Exact solutions that several cases use."""
import numpy as np
from scipy.linalg import eigh
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


def square_plate(side, thickness, E, nu, rho, clamped, count, degree=14):
    """Frequencies (1/time) of a thin square plate, free or clamped along one side, rigid ones left out: Ritz with products of Legendre's
    polynomials; degree 14 leaves less than 1e-5."""
    x, w = np.polynomial.legendre.leggauss(degree + 6)
    x, w = (x + 1) / 2, w / 2

    def one_way(clamped):
        """Integrals of products of the functions of one direction and their first and second derivatives: [i][k]."""
        rows = []
        for n in range(degree + 1):
            function = np.polynomial.Legendre.basis(n, domain=[0, 1]).convert(kind=np.polynomial.Polynomial, domain=[-1, 1], window=[-1, 1])
            function = function * np.polynomial.Polynomial([0, 0, 1]) if clamped else function
            rows.append([function.deriv(k)(x) if k else function(x) for k in range(3)])
        values = np.array(rows)  # function, derivative, point
        return np.einsum("iax,jbx,x->abij", values, values, w)
    a, b = one_way(clamped), one_way(False)
    stiffness = (np.kron(a[2, 2], b[0, 0]) + np.kron(a[0, 0], b[2, 2]) + nu * (np.kron(a[2, 0], b[0, 2]) + np.kron(a[0, 2], b[2, 0]))
                 + 2 * (1 - nu) * np.kron(a[1, 1], b[1, 1]))
    squares = eigh(stiffness, np.kron(a[0, 0], b[0, 0]), eigvals_only=True)
    scale = np.sqrt(E * thickness**2 / (12 * (1 - nu**2) * rho)) / (2 * np.pi * side**2)
    return scale * np.sqrt(squares[squares > 1][:count])
