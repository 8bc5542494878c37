"""Tip of the 45 degree bend (Bathe and Bolourchi 1979) by the equations of a Cosserat rod.

x' = L (1 + N/EA, N/GA, N/GA),  L' = L [k],  M = B (k - k0),  M' = -k x M - G x N,  N = L^T f

by shooting from the clamp with the classical method of Runge and Kutta, extrapolated. Prints, for each end force out of
the plane, the displacement along the clamp's tangent, towards the centre and out of the plane.
"""

import math

import numpy as np

RADIUS, ANGLE = 100.0, math.pi / 4
STRETCH = 1 / np.array([1e7, 5e6, 5e6])
RIGIDITY = np.array([5e6 / 6, 1e7 / 12, 1e7 / 12])
NATURAL = np.array([0.0, 1 / RADIUS, 0.0])
# Columns: along the rod, axis 1 out of the plane, axis 2.
CLAMP = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])


def cross_matrix(k):
    return np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])


def rates(state, force):
    _, frame, moment = state
    normal = frame.T @ force
    strain = np.array([1.0, 0, 0]) + STRETCH * normal
    curvature = NATURAL + moment / RIGIDITY
    return frame @ strain, frame @ cross_matrix(curvature), -np.cross(curvature, moment) - np.cross(strain, normal)


def shoot(moment, force, steps):
    h = RADIUS * ANGLE / steps
    state = (np.zeros(3), CLAMP, moment)
    moved = lambda rate, factor: tuple(a + factor * h * b for a, b in zip(state, rate))
    for _ in range(steps):
        one = rates(state, force)
        two = rates(moved(one, 0.5), force)
        three = rates(moved(two, 0.5), force)
        four = rates(moved(three, 1.0), force)
        state = tuple(a + h / 6 * (k + 2 * l + 2 * m + n) for a, k, l, m, n in zip(state, one, two, three, four))
    return np.concatenate([state[0], state[2]])


def extrapolated(moment, force):
    return (16 * shoot(moment, force, 400) - shoot(moment, force, 200)) / 15


def tip(load):
    moment = np.zeros(3)
    for share in np.linspace(0.1, 1, 10):
        force = np.array([0, 0, share * load])
        for _ in range(20):
            end = extrapolated(moment, force)[3:]
            step = 1e-4 * (1 + np.linalg.norm(moment))
            slope = [(extrapolated(moment + step * unit, force)[3:] - end) / step for unit in np.eye(3)]
            change = np.linalg.solve(np.array(slope).T, end)
            moment = moment - change
            if np.linalg.norm(change) < 1e-12 * np.linalg.norm(moment):
                break
    drawn = RADIUS * np.array([math.sin(ANGLE), 1 - math.cos(ANGLE), 0])
    return extrapolated(moment, force)[:3] - drawn


for load in (300, 450, 600):
    print(load, *(f"{value:.9f}" for value in tip(load)))
