from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.statespace.chain import solve_chain


def random_chain(seed: int, length: int, width: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(length, width, width))
    H = root @ root.transpose(0, 2, 1) * rng.choice([0.0, 1.0], size=(length, 1, 1))
    H[0] += np.eye(width)
    g = rng.normal(size=(length, width))
    F = np.eye(width) + 0.3 * rng.normal(size=(max(length - 1, 1), width, width))
    noise = rng.normal(size=(max(length - 1, 1), width, width))
    W = noise @ noise.transpose(0, 2, 1) + 0.1 * np.eye(width)
    return H, g, F, W


def dense_normal(H: np.ndarray, F: np.ndarray, W: np.ndarray) -> np.ndarray:
    length, width = H.shape[:2]
    whole = np.zeros((length * width, length * width))
    for k in range(length):
        here = slice(k * width, (k + 1) * width)
        whole[here, here] += H[k]
        if k + 1 < length:
            step = np.zeros((width, length * width))
            step[:, here] = -F[k]
            step[:, (k + 1) * width : (k + 2) * width] = np.eye(width)
            whole += step.T @ W[k] @ step
    return whole


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 8), st.integers(1, 5))
def test_states_and_covariances_are_those_of_the_dense_normal_equations(
    seed: int, length: int, width: int
) -> None:
    H, g, F, W = random_chain(seed, length, width)
    inverse = np.linalg.inv(dense_normal(H, F, W))
    wanted = (inverse @ g.ravel()).reshape(length, width)
    x, P = np.zeros((length, width)), np.zeros((length, width, width))
    assert solve_chain(H.copy(), g.copy(), F, W, x, P)
    np.testing.assert_allclose(x, wanted, rtol=1e-6, atol=1e-6 * np.abs(wanted).max())
    for k in range(length):
        here = slice(k * width, (k + 1) * width)
        np.testing.assert_allclose(
            P[k], inverse[here, here], rtol=1e-6, atol=1e-6 * np.abs(inverse[here, here]).max()
        )


def test_states_that_nothing_determines_are_refused() -> None:
    H, g = np.zeros((3, 2, 2)), np.zeros((3, 2))
    F, W = np.tile(np.eye(2), (2, 1, 1)), np.tile(np.eye(2), (2, 1, 1))
    assert not solve_chain(H, g, F, W, np.zeros((3, 2)), np.zeros((3, 2, 2)))


def test_an_epoch_without_measurements_lies_between_its_neighbours() -> None:
    H, g = np.zeros((3, 1, 1)), np.zeros((3, 1))
    H[0], H[2], g[0, 0], g[2, 0] = 1e6, 1e6, 1e6 * 2.0, 1e6 * 4.0
    F, W = np.ones((2, 1, 1)), np.ones((2, 1, 1))
    x, P = np.zeros((3, 1)), np.zeros((3, 1, 1))
    assert solve_chain(H, g, F, W, x, P)
    np.testing.assert_allclose(x[:, 0], [2.0, 3.0, 4.0], atol=1e-4)
    assert P[1, 0, 0] > 0.4
