"""Integrates an ensemble of towed wheels with heyoka, for comparison with benches/ensemble.rs.

Reads little-endian doubles from standard input: the number of trajectories, the duration, the tolerance, the number of
repetitions, the coefficients v, omega, l, m, M, J, k of the model, then the initial states (u, q, psi, V, Omega), one after
the other. Writes the smallest processor time in seconds and the final states in the same order. heyoka gets the same
quadratic form of the equations as the ensemble, which is its faster form too, and the faster of two batch sizes.
"""

import sys
import time

import heyoka as hy
import numpy as np

BATCH_SIZES = (4, 8)


def equations(v, omega, l, m, M, J, k):
    """The rolling wheel in the states a, b, C, S, psi, V, Omega."""
    a, b, C, S, psi, V, Omega = hy.make_vars("a", "b", "C", "S", "psi", "V", "Omega")
    W = omega - Omega
    return [
        (a, V - v * C + Omega * b),
        (b, l * Omega - v * S - Omega * a),
        (C, -S * W),
        (S, C * W),
        (psi, W),
        (V, (m * Omega * Omega - k * a) / M),
        (Omega, (-m * V * Omega - k * l * b) / J),
    ]


def main():
    data = np.frombuffer(sys.stdin.buffer.read(), dtype="<f8")
    count, duration, tolerance, repetitions = int(data[0]), data[1], data[2], int(data[3])
    u, q, psi, V, Omega = data[11:].reshape(count, 5).T
    C, S = np.cos(psi), np.sin(psi)
    initial = np.array([u * C - q * S, u * S + q * C, C, S, psi, V, Omega])
    final = np.empty_like(initial)
    best = np.inf
    for batch in BATCH_SIZES:
        integrator = hy.taylor_adaptive_batch(equations(*data[4:11]), np.zeros((7, batch)), tol=tolerance)
        for _ in range(repetitions):
            start = time.thread_time()
            for first in range(0, count, batch):
                integrator.set_time(0.0)
                integrator.state[:] = initial[:, first : first + batch]
                integrator.propagate_until(duration)
                final[:, first : first + batch] = integrator.state
            best = min(best, time.thread_time() - start)
    a, b, _, _, psi, V, Omega = final
    C, S = np.cos(psi), np.sin(psi)
    states = np.array([a * C + b * S, b * C - a * S, psi, V, Omega]).T
    sys.stdout.buffer.write(np.concatenate(([best], states.ravel())).astype("<f8").tobytes())


if __name__ == "__main__":
    main()
