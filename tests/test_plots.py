#!/usr/bin/python3
"""plots-scripts/plot on small made-up results: figures exist and show something, bad files give one line and status 2.
Usage: test_plots.py [PLOT]"""
import os
import subprocess
import sys
import tempfile
import traceback

import h5py
import numpy as np

sys.dont_write_bytecode = True
REPOSITORY = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PLOT = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else os.path.join(REPOSITORY, "plots-scripts", "plot")
sys.path.insert(0, os.path.dirname(PLOT))


# --- made-up results -------------------------------------------------------------------------------------------------------

def table(file, path, columns, units="m"):
    group = file.require_group(path)
    for name, values in columns.items():
        text = isinstance(values[0], str)
        group[name] = np.array(values, dtype=h5py.string_dtype() if text else float)
        group[name].attrs["units"] = "rad/s" if name == "omega" else units
        group[name].attrs["description"] = "continuation parameter" if name == "omega" else name
    return group


def branch(file, name, omega, A, B, n_unstable):
    table(file, f"/branches/{name}", {"omega": omega, "q1_h2": A, "q2_h2": B, "n_unstable": n_unstable,
                                      "arclength": np.arange(len(omega), dtype=float)})


def study(file, kind):
    attributes = {"kind": kind, "outcome": "complete", "continuation.parameter": "omega", "response.order": 2.0,
                  "support_motion.amplitude": 0.5, "damping.out_of_plane": 0.01, "damping.in_plane": 0.02,
                  "model.terms": "reduced", "cable.coefficients": "exact"}
    for key, value in attributes.items():
        file.require_group("study").attrs[key] = value


def branches(file):
    """In plane from 1 to 2 rad/s, unstable beyond the whirling point at 1.45; whirling from there to a fold at 1.95."""
    omega = np.linspace(1, 2, 11)
    branch(file, "IP1", omega, 0 * omega, omega, omega > 1.45)
    s = np.linspace(0, 1, 12)
    branch(file, "W1", 1.45 + 2 * s * (1 - 0.5 * s) * 0.5, 2 * s, 1.45 + s, s > 0.9)
    table(file, "/special_points", {
        "branch": ["IP1", "W1"], "label": ["BP1", "LP1"], "type": ["BP", "LP"], "subtype": ["WH", ""], "omega": [1.45, 1.94],
        "q1_h2": [0.0, 1.8], "q2_h2": [1.45, 2.35], "arclength": [4.5, 9.9], "unstable_before": [0, 0], "unstable_after": [1, 1]})


def wave(omega, n1, a1, a2, samples, closed):
    t = np.linspace(0, 2 * np.pi / omega, samples, endpoint=closed)
    return {"t": t, "q1": a1 * np.cos(n1 * omega * t), "q2": 0.5 * np.cos(omega * t) + a2 * np.sin(2 * omega * t)}


def run_rows(omega, A, B, motion, multiple):
    rows = {"omega": omega, "motion": motion, "multiple": multiple}
    for i, amplitude in ((1, A), (2, B)):
        for k in range(6):
            rows[f"q{i}_h{k}"] = np.array(amplitude) if k == 2 else 0.1 * np.array(amplitude)
    return rows


def verification(file):
    """At 1.2 rad/s in plane, from two starts; at 1.6 rad/s whirling; one sweep; one failed run."""
    omega, A, B = [1.2, 1.2, 1.6, 1.6], [0, 0, 0.7, np.nan], [1.1, 1.1, 1.5, np.nan]
    table(file, "/verification/runs", run_rows(omega, A, B, ["periodic"] * 3 + ["failed"], [1, 1, 1, 0]))
    for run in range(3):
        group = table(file, f"/verification/series/run{run + 1}", wave(omega[run], 2, A[run], B[run], 64, False))
        group.attrs.update({"omega": omega[run], "motion": "periodic", "multiple": 1.0, "start": "rest"})
        table(file, f"/verification/spectra/run{run + 1}",
              {"harmonic": np.arange(9.0), "q1": A[run] * 10.0 ** -np.arange(9), "q2": B[run] * 10.0 ** -np.arange(9)})
    for name, w, a, b in (("w1.2000-1", 1.2, 0, 1.2), ("w1.6000-1", 1.6, 0, 1.6), ("w1.6000-2", 1.6, 0.4, 1.6)):
        group = table(file, f"/verification/averaged/{name}", wave(w, 2, a, b, 257, True))
        group.attrs.update({"omega": w, "branch": "IP1", "stable": float(name != "w1.6000-1")})
    sweep = run_rows([1.1, 1.3, 1.5, 1.7], [0, 0, 0.5, 0], [1.0, 1.2, 1.4, 0.3], ["periodic"] * 4, [1, 1, 1, 2])
    table(file, "/verification/sweep_up", sweep)


def orbits(file):
    for k in (1, 2):
        group = file.require_group(f"/orbits/pair{k}")
        group.attrs.update({"damping_out_of_plane": 0.01, "damping_in_plane": 0.01 * (k - 1), "omega": 1.65})
        averaged = table(file, f"/orbits/pair{k}/averaged", wave(1.65, 2, 1.5, 2, 257, True))
        averaged.attrs.update({"omega": 1.65, "stable": float(k - 1), "branch": "whirling"})
        integrated = table(file, f"/orbits/pair{k}/integrated", wave(1.65, 2, -1.8, 2.2, 64, False))
        integrated.attrs.update({"omega": 1.65, "motion": "periodic", "multiple": 1.0})


def superharmonic(path):
    with h5py.File(path, "w") as file:
        study(file, "superharmonic")
        file["cable/omega1"] = 3.0
        branches(file)
        verification(file)
        orbits(file)


def other_kind(path):
    """A kind without figures of its own, killed before its special points were written."""
    with h5py.File(path, "w") as file:
        study(file, "some-new/../kind")
        del file["study"].attrs["outcome"]
        omega = np.linspace(1, 2, 11)
        branch(file, "main", omega, omega**2, omega, omega > 1.5)


def curve(file, name, kind, subtype, omega, U, coefficient, A):
    columns = {"omega": omega, "support_motion.amplitude": U, "q1_h2": A, "q2_h2": 1 + 0 * A, "coefficient": coefficient,
               "frequency": 0 * A, "residual": 0 * A}
    table(file, f"/curves/{name}", columns).attrs.update({"type": kind, "subtype": subtype, "born_at": "IP1:BP1"})


def two_parameter(path):
    """A parabola of whirling points, least at (1.6, 0.3) and degenerate at (1.55, 0.305); a fold curve from there;
    a fold curve with a cusp at (1.8, 0.4) and a Hopf curve that ends on it."""
    with h5py.File(path, "w") as file:
        study(file, "two-parameter")
        file["study"].attrs.update({"second.parameter": "support_motion.amplitude", "continuation.range": [1.2, 2.2],
                                    "second.range": [0.2, 0.7]})
        s = np.linspace(-0.32, 0.37, 24)
        curve(file, "WH1", "BP", "WH", 1.6 + s, 0.3 + 2 * s**2, s + 0.05, 0 * s)
        s = np.linspace(0, 1, 12)
        curve(file, "LP2", "LP", "", 1.55 + 0.5 * s**2, 0.305 - 0.04 * s**2, s, s)
        s = np.linspace(-0.62, 0.61, 30)
        curve(file, "LP3", "LP", "", 1.8 + s**2, 0.4 + 0.6 * s**2 + 0.2 * s**3, s, 2 + s)
        s = np.linspace(0.4, 0.6, 12)
        curve(file, "HB4", "HB", "", 1.8 + s**2, 0.4 + 0.6 * s**2 + 0.25 * s**3 - 0.0032, np.where(s > 0.4, -1, np.nan), 2 + s)
        table(file, "/special_points", {
            "curve": ["WH1", "WH1", "LP3", "LP3", "LP3", "HB4"], "type": ["DP", "MIN", "CP", "MIN", "BT", "BT"],
            "omega": [1.55, 1.6, 1.8, 1.8, 1.96, 1.96],
            "support_motion.amplitude": [0.305, 0.3, 0.4, 0.4, 0.5088, 0.5088], "residual": [0.0] * 6})


def modes(path):
    """Three symmetric modes, two antisymmetric, one out of plane, of a cable beyond its first cross-over."""
    with h5py.File(path, "w") as file:
        study(file, "modes")
        for name, value in {"sag_ratio": 0.02, "lambda2": 60.0, "chord_tension": 2e4}.items():
            file[f"cable/{name}"] = value
        b = np.pi * np.array([1, 2.3, 2, 3.1, 4, 5.02])
        table(file, "/modes", {"mode": ["y1", "z1", "z2", "z3", "z4", "z5"],
                               "family": ["out of plane"] + ["symmetric", "antisymmetric"] * 2 + ["symmetric"], "frequency_number": b})
        xi = np.linspace(0, 1, 51)
        for k, family in ((1, "symmetric"), (2, "antisymmetric"), (3, "symmetric"), (4, "antisymmetric")):
            group = table(file, f"/shapes/z{k}", {"xi": xi, "transverse": np.sin(k * np.pi * xi), "longitudinal": 0.01 * np.sin(np.pi * xi)})
            group.attrs.update({"family": family, "order": 1.0, "frequency": 0.4 * k})
        lambda2 = np.logspace(-1, 4, 60)
        table(file, "/cross_over", {"lambda2": lambda2, **{f"symmetric{n}": np.pi * (2 * n - 1 + 1.9 * lambda2 / (lambda2 + 40 * n**2))
                                                           for n in (1, 2, 3, 4)}})
        table(file, "/symmetric_forms", {"xi": xi, **{f"form{n}": np.sin(np.pi * xi)**n for n in (1, 2, 3)}}).attrs["lambda2"] = [9.9, 39.5, 158.0]


def mode_convergence(path):
    with h5py.File(path, "w") as file:
        study(file, "mode-convergence")
        file["study"].attrs.update({"peak.harmonic": 2.0, "peak.amplitude": 0.15, "peak.station": 0.5})
        n = np.array([1, 2, 3, 1, 2, 3])
        table(file, "/convergence", {"longitudinal": ["galerkin"] * 3 + ["quasi-static"] * 3, "modes": n,
                                     "threshold": np.where(n == 2, np.nan, 0.35 + 0.01 / n), "threshold_omega": 1.6 + 0.01 / n,
                                     "peak": 1.1 - 0.02 / n, "peak_omega": 1.61 + 0.001 * n})


def continuation(path):
    """Rest points of a pitchfork in (x, y) with an isola in x alone; mu varies, lambda is fixed."""
    with h5py.File(path, "w") as file:
        file.require_group("study").attrs.update({"kind": "continuation", "outcome": "complete", "continuation.parameter": "mu"})
        table(file, "/model/parameters", {"mu": [0.5], "lambda": [1.25]})
        for name in ("mu", "lambda"):
            del file[f"model/parameters/{name}"]
            file[f"model/parameters/{name}"] = 1.25
        mu, angle = np.linspace(-1, 1, 21), np.linspace(0, 2 * np.pi, 30)
        for name, p, x, unstable in (("B1", mu, 0 * mu, mu > 0), ("B2", mu[10:], np.sqrt(mu[10:]), mu[10:] < 0),
                                     ("B3", 0.3 * np.cos(angle), 2 + 0.4 * np.sin(angle), np.sin(angle) < 0)):
            group = table(file, f"/branches/{name}", {"mu": p, "x": x, "y": 0 * x, "n_unstable": unstable,
                                                      "arclength": np.arange(len(p), dtype=float)}, units="-")
            group["mu"].attrs["description"] = "continuation parameter"
            for column in ("x", "y"):
                group[column].attrs["description"] = "variable"
            group.attrs["isola"] = float(name == "B3")
        table(file, "/special_points", {"branch": ["B1", "B3"], "label": ["BP1", "LP1"], "type": ["BP", "LP"], "subtype": ["PF", ""],
                                        "mu": [0.0, 0.3], "x": [0.0, 2.0], "y": [0.0, 0.0], "arclength": [10.0, 0.0],
                                        "unstable_before": [0, 0], "unstable_after": [1, 1]}, units="-")


def slow_flow(path):
    """In plane from 1.9 to 2.2 rad/s; a coupled motion of period 2T from 1.95 on; settled motions of both kinds at 2.1."""
    with h5py.File(path, "w") as file:
        study(file, "slow-flow")
        file["study"].attrs.update({"nu": 2.0, "ansatz.kind": "combinatorial-32", "ansatz.motion": "coupled"})
        omega = np.linspace(1.9, 2.2, 13)
        for name, A, unstable, modulus in (("IP1", 0, omega > 1.95, 0.9 + 0.4 * (omega > 2.0)), ("WD1", 1, omega < 0, 0.8)):
            table(file, f"/branches/{name}", {
                "omega": omega, "q1_h0.5": A * (omega - 1.8), "q1_h1.5": 2 * A * (omega - 1.8), "q2_h0": 0.3 + 0 * omega, "q2_h1": omega / 2,
                "q2_h2": 1 / omega, "n_unstable": unstable, "floquet_modulus": modulus + 0 * omega, "arclength": np.arange(13.0)})
        table(file, "/special_points", {
            "branch": ["IP1"], "label": ["BP1"], "type": ["BP"], "subtype": ["WH"], "omega": [1.95], "q1_h0.5": [0.0], "q1_h1.5": [0.0],
            "q2_h0": [0.3], "q2_h1": [0.975], "q2_h2": [0.51], "arclength": [2.0], "unstable_before": [0], "unstable_after": [1]})
        table(file, "/verification/runs", {
            "omega": [2.1, 2.1, 2.1], "q1_h0.5": [0.3, 0.3, 0.0], "q1_h1.5": [0.6, 0.6, 0.0], "q2_h0": [0.3] * 3, "q2_h1": [1.0] * 3,
            "q2_h2": [0.5] * 3, "motion": ["periodic"] * 3, "multiple": [2.0] * 3, "branch": ["WD1", "WD1", ""]})

        def coupled(t, size):
            w = 2.1
            return {"t": t, "q1": size * (np.cos(w * t / 2) + 2 * np.cos(1.5 * w * t)), "q2": 0.3 + np.cos(w * t) + 0.5 * np.cos(2 * w * t)}

        span = 4 * np.pi / 2.1
        for run, size in ((1, 0.3), (2, -0.3), (3, 0.0)):
            about = {"omega": 2.1, "motion": "periodic", "multiple": 2.0, "start": "q1 = 3, q2 = 0"}
            table(file, f"/verification/series/run{run}", coupled(span * np.arange(64) / 64, size)).attrs.update(about)
            h = np.arange(11) / 2
            table(file, f"/verification/spectra/run{run}", {"harmonic": h, "q1": abs(size) * 10.0 ** -h, "q2": 10.0 ** -h}).attrs.update(about)
        table(file, "/verification/transients/run2", coupled(np.linspace(0, 9 * span, 400), 1.0)).attrs.update(about)
        for name, size in (("w2.1000-1", 0.35), ("w2.1000-2", 0.2)):
            orbit = table(file, f"/verification/averaged/{name}", coupled(np.linspace(0, span, 129), size))
            orbit.attrs.update({"omega": 2.1, "branch": "WD1", "stable": float(size > 0.3)})


def states(omega, multiple, a1, a2, samples=64):
    t = np.arange(samples * max(multiple, 8)) * 2 * np.pi / omega / samples if multiple == 0 else \
        np.arange(samples * multiple) * 2 * np.pi / omega / samples
    w = omega / multiple if multiple else 1.03 * omega
    return {"t": t, "q1": a1 * np.cos(w * t), "q2": a2 * np.cos(omega * t), "q1'": -a1 * w * np.sin(w * t),
            "q2'": -a2 * omega * np.sin(omega * t)}


def attractor(file, group, omega, motion, multiple, a1, a2):
    series = states(omega, multiple, a1, a2)
    table(file, f"{group}/series", series)
    columns = [q for q in series if q != "t"]
    points = 300 if multiple == 0 else multiple
    at = np.arange(points) * 2 * np.pi * (1.03 if multiple == 0 else 1 / multiple)
    values = [a1 * np.cos(at), a2 + 0 * at, -a1 * np.sin(at), 0 * at]
    table(file, f"{group}/section", dict(zip(columns, values)))
    table(file, f"{group}/spectrum", {"coordinate": [1, 1, 2, 2], "harmonic": [0.5, 1.5, 1, 2], "amplitude": [a1, 0.1 * a1, a2, 0.01],
                                      "phase": [0.0] * 4})
    if multiple == 0:
        h = np.arange(0, 8.01, 1 / 16)
        table(file, f"{group}/amplitude_spectrum", {"harmonic": h, "q1": a1 * np.exp(-20 * (h - 1) ** 2) + 1e-4, "q2": 1e-3 + 0 * h})
    file[group].attrs.update({"omega": omega, "motion": motion, "multiple": float(multiple)})


def attractor_table(file, path, names, omega, motion, multiple, extra):
    rows = len(names)
    table(file, path, {"attractor": names, "motion": motion, "mirror": ["A2", "A1"] + [""] * (rows - 2), "omega": omega,
                       "multiple": multiple, "lyapunov": [-0.03] * rows, "lyapunov_error": [0.001] * rows,
                       "second_frequency": [0.0] * (rows - 1) + [0.03], **extra})


def integrated(path):
    """Two mirror images of period one, a motion of period two, a quasi-periodic one; two sweeps with a jump and a change."""
    with h5py.File(path, "w") as file:
        study(file, "integrate")
        file["study"].attrs.update({"sweep.parameter": "omega", "integrate.section_phase_deg": 0.0})
        names, kinds, multiple = ["A1", "A2", "A3", "A4"], ["periodic"] * 3 + ["quasi-periodic"], [1, 1, 2, 0]
        omega = [1.65, 1.65, 2.1, 1.75]
        for name, kind, m, w in zip(names, kinds, multiple, omega):
            attractor(file, f"/integrate/{name}", w, kind, m, 1.5, 1.0)
        attractor_table(file, "/integrate/attractors", names, omega, kinds, multiple, {})
        table(file, "/integrate/runs", {"omega": omega, "start": ["q1 = 3"] * 4, "motion": kinds, "attractor": names})
        for k, w in enumerate(omega):
            table(file, f"/integrate/run{k + 1}", states(w, 8, 1.0, 2.0)).attrs.update({"omega": w, "start": "q1 = 3"})
        p = np.linspace(1.4, 2.0, 13)
        for way, at in (("up", 1.8), ("down", 1.7)):
            table(file, f"/sweep/{way}", {"omega": p, "multiple": 1 + (p > 1.9), "q1_rms": np.where(p < at, 0.5 * p, 0), "q2_rms": p})
            table(file, f"/sweep/transitions_{way}", {"before": [at - 0.01, 1.9], "after": [at + 0.01, 1.91], "jump": [1, 0],
                                                      "q1_rms_before": [0.9, 0], "q1_rms_after": [0, 0], "q2_rms_before": [1.8, 1.9],
                                                      "q2_rms_after": [1.8, 1.9], "what": ["jump", "change"]})


def basin_map(path):
    """Half a plane each for two mirror images, a disc of a third, a corner that diverges, one cell unsettled."""
    with h5py.File(path, "w") as file:
        study(file, "basins")
        x, y = np.meshgrid(np.linspace(-3, 3, 31), np.linspace(-2, 2, 21))
        number = np.where(x > 0, 1, 2)
        number[x**2 + y**2 < 1] = 3
        number[(x > 2) & (y > 1)] = -1
        number[0, 0] = 0
        table(file, "/basins/map", {"x": x.ravel(), "y": y.ravel(), "attractor": number.ravel(), "periods": 50 + 0 * x.ravel()})
        file["basins"].attrs.update({"axes": ["q1", "q2"], "resolution": [31.0, 21.0], "omega": 1.65, "symmetry": "WH"})
        file["basins/checked"], file["basins/disagreed"] = 20.0, 1.0
        names, kinds, multiple = ["A1", "A2", "A3"], ["periodic", "periodic", "chaotic"], [1, 2, 0]
        for name, kind, m in zip(names, kinds, multiple):
            attractor(file, f"/basins/{name}", 1.65, kind, m, 1.5, 1.0)
        attractor_table(file, "/basins/attractors", names, [1.65] * 3, kinds, multiple,
                        {"number": [1, 2, 3], "share": [0.4, 0.4, 0.1], "cells": [260, 260, 65]})
        table(file, "/basins/points", {"attractor": [1, 2, 2] + [3] * 40, "q1": np.linspace(-2, 2, 43), "q2": np.linspace(1, -1, 43),
                                       "q1'": np.zeros(43), "q2'": np.zeros(43)})


def guy(file, kind):
    file.require_group("study").attrs.update({"kind": kind, "outcome": "complete", "guy.horizontal_span": 90.0, "guy.rise": 120.0,
                                              "condition.ice_mass_per_length": 1.5, "condition.temperature_change": -15.0})
    for name, value in {"horizontal_tension": 4.5e4, "r": 0.05, "irvine_lambda2": 3.1, "modulus": 1.4e5, "taut_modulus": 1.7e5}.items():
        file[f"guy/{name}"] = value


def guy_statics(path):
    with h5py.File(path, "w") as file:
        guy(file, "guy-statics")
        d = np.linspace(-0.5, 0.5, 21)
        for name, factor in (("exact", 1.0), ("first_order", 0.99)):
            table(file, f"/curve/{name}", {"displacement": d, "horizontal_tension": factor * (4.5e4 + 1.4e5 * d + 5e4 * d**2), "modulus": factor * (1.4e5 + 1e5 * d)})
        for k, t in enumerate((0.0, 30.0)):
            part = table(file, f"/groups/direction{k}", {"displacement": d, "reaction": 2e5 * d, "reaction_axial": 1.98e5 * d, "reaction_across": k * 1e4 * d**2})
            part.attrs.update({"direction_deg": t, "azimuths_deg": [0.0, 120.0, 240.0], "tangent": 2e5, "tangent_axial": 1.98e5})
        s = np.linspace(0, 1, 7)
        shape = {"x": 90 * s, "y": 120 * s - 4 * s * (1 - s)}
        table(file, "/static_curve", shape)
        for name in ("funicular", "hung"):
            table(file, f"/lumped/{name}", shape).attrs["horizontal_tension"] = 4.5e4


def guy_modes(path):
    with h5py.File(path, "w") as file:
        guy(file, "guy-modes")
        s, modes = np.linspace(0, 1, 41), np.arange(1, 4)
        table(file, "/modes/transverse", {"mode": modes, "omega": 2.5 * modes, "omega_string": 2.6 * modes})
        table(file, "/modes/transverse_shapes", {"sigma": s} | {f"{n}_{i}": np.sin(i * np.pi * s) for i in modes for n in ("guy", "string")})
        for plane, names in (("in_plane", ("normal", "tangential")), ("out_of_plane", ("z",))):
            table(file, f"/modes/{plane}", {"mode": modes, "omega": 2.7 * modes})
            table(file, f"/modes/{plane}_shapes", {"sigma": s} | {f"{n}_{i}": np.sin(i * np.pi * s) for i in modes for n in names})
        H = np.geomspace(1e4, 1e6, 9)
        table(file, "/scan", {"horizontal_tension": H, "irvine_lambda2": 1e13 / H**2.5, "omega_string": np.sqrt(H)} |
              {f"{n}_{i}": i * np.sqrt(H) for i in modes for n in ("in_plane", "out_of_plane")})


def guy_stiffness(path):
    with h5py.File(path, "w") as file:
        guy(file, "guy-stiffness")
        x = np.linspace(0.02, 4, 200)
        K = 1e5 * (1 - x / (1.5**2 - x**2 + 0.02j * x))
        columns = {"omega_ratio": x, "full_re": K.real, "full_im": np.abs(K.imag) + 1.0}
        columns |= {"classical_re": 1.1 * K.real, "classical_im": -K.imag, "error_classical": 0.1 + 0 * x}
        table(file, "/stiffness/horizontal", columns).attrs.update({"static": 1e5, "taut": 1.7e5, "damping_rate": 0.01})
        table(file, "/stiffness/matrix", {"omega_ratio": x} | {f"{n}_{p}": np.abs(K) for n in ("xy", "yy", "zz") for p in ("re", "im")})
        level = table(file, "/stiffness/level", {"omega_ratio": x} | {f"{n}_{p}": np.abs(K) for n in ("XX", "YY", "ZZ") for p in ("re", "im")})
        level.attrs["azimuths_deg"] = [0.0, 120.0, 240.0]
        table(file, "/poles_and_zeros", {"omega_ratio": [1.2, 1.5], "direction": ["horizontal"] * 2, "type": ["zero", "pole"]})
        n = np.arange(4.0, 30.0, 2.0)
        table(file, "/convergence", {"degree": n, "error_galerkin": 10.0**-n, "error_collocation": 10.0 ** (2 - n)}).attrs.update(
            {"omega": 9.4, "reference_degree": 100.0})
        X = np.linspace(0.1, 12, 300)
        table(file, "/longitudinal", {"X": X, "displacement": np.tan(X) / X, "force": X / np.tan(X), "displacement_damped": np.abs(np.tan(X) / X),
                                      "force_damped": np.abs(X / np.tan(X))}).attrs.update({"alpha": 0.8, "wave_speed": 2000.0})


# --- helpers ---------------------------------------------------------------------------------------------------------------

def plot(*arguments):
    return subprocess.run([PLOT, *arguments], capture_output=True, text=True, timeout=300)


def check(condition, words):
    if not condition:
        raise AssertionError(words)


def check_picture(path, most=0.6):
    """A PNG of a page's size with ink of several colours on it, on at most a share of it."""
    from matplotlib.image import imread
    pixels = imread(path)
    check(pixels.shape[0] > 300 and pixels.shape[1] > 500, f"{path}: {pixels.shape}")
    colours = np.unique((pixels[..., :3] * 15).astype(int).reshape(-1, 3), axis=0)
    ink = np.mean(np.any(pixels[..., :3] < 0.9, axis=-1))
    check(len(colours) > 20 and 0.005 < ink < most, f"{path}: {len(colours)} colours, {ink:.3f} of it inked")


def check_document(path):
    with open(path, "rb") as file:
        content = file.read()
    whole = content.startswith(b"%PDF-") and b"%%EOF" in content[-64:]
    check(whole and b"/FontFile2" in content, f"{path}: not a PDF with vector fonts")


def check_refused(folder, name, words):
    before = sorted(os.listdir(folder))
    done = plot(os.path.join(folder, name))
    check(done.returncode == 2, f"{name}: status {done.returncode}, {done.stderr}")
    check(done.stderr.count("\n") == 1 and name in done.stderr and words in done.stderr, f"{name}: {done.stderr}")
    check(done.stdout == "" and sorted(os.listdir(folder)) == before, f"{name}: something was written")


# --- tests -----------------------------------------------------------------------------------------------------------------

def test_superharmonic_figures(folder):
    path = os.path.join(folder, "made-up.h5")
    superharmonic(path)
    done = plot(path)
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    names = ["response", "orbits", "orbits-verification", "spectrum", "time", "error"]
    expected = sorted(os.path.join(folder, f"made-up-{n}.{f}") for n in names for f in ("png", "pdf"))
    check(sorted(done.stdout.split("\n")[:-1]) == expected, done.stdout)
    check(sorted(os.listdir(folder)) == sorted(["made-up.h5"] + [os.path.basename(p) for p in expected]), "stray files")
    for p in expected:
        (check_picture if p.endswith("png") else check_document)(p)


def test_folder_and_format(folder):
    path, target = os.path.join(folder, "made-up.h5"), os.path.join(folder, "deep", "figures")
    superharmonic(path)
    done = plot(path, "-o", target, "--format", "png")
    check(done.returncode == 0, done.stderr)
    check(len(os.listdir(target)) == 6 and all(n.endswith(".png") for n in os.listdir(target)), str(os.listdir(target)))
    check(sorted(os.listdir(folder)) == ["deep", "made-up.h5"], "figures beside the file as well")


def test_other_kind_gets_bifurcation_diagram(folder):
    path = os.path.join(folder, "other.h5")
    other_kind(path)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and os.listdir(folder).count("other-branches.png") == 1, done.stderr)
    check_picture(os.path.join(folder, "other-branches.png"))


def test_continuation_diagram(folder):
    """A variable that never moves gets no panel; isolas and fixed parameters stand in the caption."""
    from figures_continuation import panel_columns, words
    from figures_common import study_words
    from result_file import read
    path = os.path.join(folder, "rest.h5")
    continuation(path)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "" and os.listdir(folder).count("rest-branches.png") == 1, done.stderr)
    check_picture(os.path.join(folder, "rest-branches.png"))
    result, names = read(path), ["B1", "B2", "B3"]
    check(panel_columns(result, names) == ["x"], str(panel_columns(result, names)))
    caption = study_words(result, words(result, names)).replace("\u00a0", " ")
    check(caption == "3 branches (B3 isola), lambda = 1.25", caption)


def test_stability_segments(folder):
    """Segments change at the special points, not at the computed points beside them."""
    from figures_common import knots_of
    from result_file import read
    path = os.path.join(folder, "made-up.h5")
    superharmonic(path)
    knots = knots_of(read(path), "IP1", ["omega"])
    pieces = [(stable, *knots.columns["omega"][[first, last]]) for stable, first, last in knots.pieces()]
    check(np.allclose(pieces, [(1, 1, 1.45), (0, 1.45, 2)]), str(pieces))


def test_error_against_nearest_stable(folder):
    """The unstable in-plane state at 1.6 rad/s is no partner; runs that settle on one motion count once."""
    from result_file import read
    from superharmonic_motions import AveragedBranches, compare, distinct_motions
    path = os.path.join(folder, "made-up.h5")
    superharmonic(path)
    result = read(path)
    motions = distinct_motions(result)
    check([(m.omega, m.runs) for m in motions] == [(1.2, 2), (1.6, 1)], str(motions))
    states = AveragedBranches(result, 2)
    planar, whirling = (compare(states.at(m.omega), m) for m in motions)
    check(np.isclose(planar.error["B"], 1.2 - 1.1) and planar.counterpart, str(planar))
    check(len(states.at(1.0)) == 1 and len(states.at(2.0)) == 1 and not states.at(2.1), "states at the ends of the range")
    check(whirling.averaged.stable and whirling.averaged.A > 0.2 and whirling.counterpart, str(whirling))


def test_slow_flow_figures(folder):
    path = os.path.join(folder, "comb.h5")
    slow_flow(path)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    names = [f"comb-{n}.png" for n in ("orbits", "response", "starts", "time")]
    check(sorted(os.listdir(folder)) == sorted(["comb.h5", *names]), str(os.listdir(folder)))
    for name in names:
        check_picture(os.path.join(folder, name))


def test_slow_flow_reading(folder):
    """Mirror images count once; a doubt is where Floquet multipliers and averaged stability differ; the partner is turned to the run's side."""
    from figures_slow_flow import aligned, contradicted, fraction, motions
    from result_file import read
    path = os.path.join(folder, "comb.h5")
    slow_flow(path)
    result = read(path)
    found = motions(result)
    check([(m.run, m.branch, m.words()) for m in found] == [(1, "WD1", "coupled, 2T"), (3, "", "in plane, 2T")], str(found))
    omega = result.group("branches/IP1").column("omega")
    check(np.array_equal(contradicted(result.group("branches/IP1")), (omega > 1.95) & (omega <= 2.0)), "doubts")
    _, integrated, nearest = aligned(result, found[0])
    check(np.max(np.abs(integrated["q1"] - 0.3 / 0.35 * nearest["q1"])) < 0.02, "the stable partner, on the run's side")
    check([fraction(h) for h in (1, 2, 0.5, 1.5)] == [r"$\omega$", r"2$\omega$", r"$\omega$/2", r"3$\omega$/2"], fraction(0.5))


def test_slow_flow_of_other_coordinates(folder):
    """A model of three coordinates, the second of which may change its sign: what moves most is drawn, by its own name."""
    from figures_slow_flow import aligned, leading, motions
    from result_file import read
    path = os.path.join(folder, "modal.h5")
    slow_flow(path)
    with h5py.File(path, "r+") as file:
        file["study"].attrs["mirrored"] = "z7"
        for group in [file["verification"], file["branches"], file["special_points"]]:
            tables = [group] if "omega" in group else [g for g in group.values() if isinstance(g, h5py.Group)]
            tables += [t for g in tables for t in g.values() if isinstance(t, h5py.Group)]
            for t in tables:
                for old in [c for c in t if c.startswith("q1")]:
                    t.move(old, "z7" + old[2:])
                if "z7" in t:
                    t["x"] = 1e-6 * t["z7"][()]
                    t["x"].attrs.update(t["z7"].attrs)
    result = read(path)
    found = motions(result)
    check([m.words() for m in found] == ["coupled, 2T", "in plane, 2T"], str([m.words() for m in found]))
    check(set(leading([m.series for m in found])) == {"q2", "z7"}, str(leading([m.series for m in found])))
    _, integrated, nearest = aligned(result, found[0])
    check(np.max(np.abs(integrated["z7"] - 0.3 / 0.35 * nearest["z7"])) < 0.02, "the partner, on the run's side")
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    for name in ("orbits", "response", "starts", "time"):
        check_picture(os.path.join(folder, f"modal-{name}.png"))


def test_two_parameter_chart(folder):
    path = os.path.join(folder, "plane.h5")
    two_parameter(path)
    done = plot(path)
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    check(sorted(os.listdir(folder)) == ["plane-chart.pdf", "plane-chart.png", "plane.h5"], str(os.listdir(folder)))
    check_picture(os.path.join(folder, "plane-chart.png"))
    check_document(os.path.join(folder, "plane-chart.pdf"))


def test_two_parameter_reading(folder):
    """A place has one point; whirling curves change line at the degenerate pitchfork; a cusp is sharp, and of its own curve."""
    from figures_two_parameter import curve_of, points_of
    from result_file import read
    path = os.path.join(folder, "plane.h5")
    two_parameter(path)
    result, axes, scale = read(path), ("omega", "support_motion.amplitude"), np.array([1.0, 0.5])
    points = points_of(result, *axes, scale)
    check([(p.kind, p.curve) for p in points] == [("DP", "WH1"), ("BT", "LP3"), ("CP", "LP3"), ("threshold", "WH1")], str(points))
    check(points[1].curves == {"LP3", "HB4"}, str(points[1]))
    wh, lp3 = (curve_of(result, name, *axes, scale, points) for name in ("WH1", "LP3"))
    pieces = [(line, *wh.xy[[first, last], 0]) for line, first, last in wh.pieces()]
    check([p[0] for p in pieces] == ["solid", "dotted"], str(pieces))
    check(np.allclose([p[1:] for p in pieces], [(1.28, 1.55), (1.55, 1.97)]), str(pieces))
    check(len(lp3.xy) == 31 and np.allclose(lp3.xy[np.argmin(lp3.xy[:, 0])], (1.8, 0.4)), str(lp3.xy))


def test_two_parameter_cut_short(folder):
    """Killed before the special points were written, with folds alone; and before the first curve."""
    path = os.path.join(folder, "plane.h5")
    two_parameter(path)
    with h5py.File(path, "r+") as file:
        for name in ("special_points", "curves/WH1", "curves/HB4"):
            del file[name]
        del file["study"].attrs["outcome"]
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    check_picture(os.path.join(folder, "plane-chart.png"))
    with h5py.File(path, "r+") as file:
        del file["curves"]
    check_refused(folder, "plane.h5", "nothing to draw")


def test_modes_figures(folder):
    path = os.path.join(folder, "cable.h5")
    modes(path)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    names = [f"cable-{n}.png" for n in ("antisymmetric", "cross-over", "roots", "shapes", "symmetric")]
    check(sorted(os.listdir(folder)) == sorted(names + ["cable.h5"]), str(os.listdir(folder)))
    for name in names:
        check_picture(os.path.join(folder, name))
    with h5py.File(path, "r+") as file:
        del file["cross_over"], file["symmetric_forms"], file["shapes/z4"]
    done = plot(path, "--format", "png", "-o", os.path.join(folder, "less"))
    check(done.returncode == 0, done.stderr)
    check(sorted(os.listdir(os.path.join(folder, "less"))) == ["cable-roots.png", "cable-shapes.png"], "figures without their tables")
    with h5py.File(path, "r+") as file:
        del file["modes"]
    check_refused(folder, "cable.h5", "nothing to draw")


def test_mode_convergence_figure(folder):
    """A threshold that was not found leaves a gap."""
    from figures_mode_convergence import sentence
    from result_file import read
    path = os.path.join(folder, "modes.h5")
    mode_convergence(path)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    check_picture(os.path.join(folder, "modes-convergence.png"))
    words = sentence(read(path).group("convergence"), ["galerkin", "quasi-static"])
    check("1.9 % at 1" in words and "differ by 0 %" in words, words)


def check_figures(path, names, most=0.6):
    done = plot(path)
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    stem = os.path.splitext(path)[0]
    expected = sorted(f"{stem}-{n}.{f}" for n in names for f in ("png", "pdf"))
    check(sorted(done.stdout.split("\n")[:-1]) == expected, done.stdout)
    for p in expected:
        if p.endswith("png"):
            check_picture(p, most)
        else:
            check_document(p)


def test_integrate_figures(folder):
    path = os.path.join(folder, "motions.h5")
    integrated(path)
    check_figures(path, ["beginnings", "motions", "sections", "sweep"])
    with h5py.File(path, "r+") as file:  # a run of sweeps alone
        del file["integrate"]
    done = plot(path, "-o", os.path.join(folder, "alone"), "--format", "png")
    check(done.returncode == 0 and os.listdir(os.path.join(folder, "alone")) == ["motions-sweep.png"], done.stderr + done.stdout)


def test_basins_figures(folder):
    path = os.path.join(folder, "map.h5")
    basin_map(path)
    check_figures(path, ["basins", "periods", "motions"], most=0.9)  # a map is coloured all over


def test_basins_reading(folder):
    """Rows of the map run along the first axis; a region's depth peels from its border; points of an attractor are its own."""
    from figures_basins import Points, depth, plane
    from result_file import read
    path = os.path.join(folder, "map.h5")
    basin_map(path)
    x, y, cells = plane(read(path))
    check(len(x) == 31 and len(y) == 21 and cells.shape == (21, 31), str(cells.shape))
    check(cells[10, 15] == 3 and cells[10, 28] == 1 and cells[10, 2] == 2 and cells[20, 30] == -1 and cells[0, 0] == 0, str(cells))
    check(depth(np.ones((5, 7), dtype=bool)).max() == 3, "depth of a block")
    check(len(Points(read(path).group("basins/points"), 2).column("q1")) == 2, "points")


def test_guys(folder):
    for kind, make, names in (("statics", guy_statics, ("force", "groups", "lumped")), ("modes", guy_modes, ("transverse", "full", "scan")),
                              ("stiffness", guy_stiffness, ("modulus", "matrix", "convergence", "longitudinal"))):
        path = os.path.join(folder, f"{kind}.h5")
        make(path)
        done = plot(path, "--format", "png")
        check(done.returncode == 0 and done.stderr == "", done.stderr)
        for name in names:
            check_picture(os.path.join(folder, f"{kind}-{name}.png"))
    with h5py.File(path, "r+") as file:  # undamped, and killed early: the rest is drawn
        for name in ("full_im", "classical_im"):
            file[f"stiffness/horizontal/{name}"][:] = 0.0
        for name in ("stiffness/matrix", "convergence", "longitudinal"):
            del file[name]
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "" and done.stdout.count("\n") == 1, done.stderr)


def test_jumps_through_infinity_are_cut(folder):
    import figures_guy_stiffness
    x, y = figures_guy_stiffness.broken(np.arange(6.0), [1.0, 5.0, -5.0, -1.0, 0.5, 1.0], 8.0)
    check(len(x) == 7 and np.isnan(x[2]) and np.isnan(y[2]) and np.sum(np.isnan(y)) == 1, f"{x} {y}")


def hanging(file, kind):
    """A level cable of span 100 m, its line a parabola."""
    file.require_group("study").attrs.update({"kind": kind, "outcome": "complete", "end_motion.end": "upper", "end_motion.tangential": [0.5]})
    numbers = {"span": 100, "height_difference": 0, "length": 110, "sag_parameter": 0.9, "flexibility": 1e-3, "half_width": 0.8,
               "horizontal_tension": 6e3, "lower_tension": 8e3, "xi_lower": -0.3, "xi_upper": 0.3}
    for name, value in numbers.items():
        file[f"cable/{name}"] = float(value)
    x = np.linspace(0, 100, 41)
    return {"s": 1.1 * x, "x": x, "y": 0.01 * x * (x - 100)}


def catenary_modes(path):
    with h5py.File(path, "w") as file:
        line = hanging(file, "catenary-modes")
        wave = [np.sin(k * np.pi * line["x"] / 100) for k in (1, 2)]
        for k, w in enumerate(wave, 1):
            table(file, f"/shapes/in_plane/mode{k}", {**line, "U": 0.1 * w, "V": w, "rotation": w, "tension": 1e3 * w})
            table(file, f"/shapes/out_of_plane/mode{k}", {**line, "W": w})
        for plane in ("in_plane", "out_of_plane"):
            table(file, f"/modes/{plane}", {"frequency": [0.1, 0.2], "kind": ["symmetric", "antisymmetric"]})
            sag = np.linspace(0.5, 0.95, 9)
            for h in ("0", "0.5"):
                table(file, f"/sweep/{plane}/h{h}", {"sag_parameter": sag, "w1": 1 / (1 - sag), "w2": 2 / (1 - sag)})
        late = np.where(sag < 0.6, np.nan, 1.01 / (1 - sag))  # no root for deep cables
        table(file, "/sweep/in_plane/h0", {"asymptotic1": late, "asymptotic2": 2.001 / (1 - sag)})


def catenary_forced(path, inside=1.0, outside=0.0, end="upper"):
    """In plane and out of plane, each with its resonance; the end that moves has the larger tension."""
    with h5py.File(path, "w") as file:
        line = hanging(file, "catenary-forced")
        file["study"].attrs["end_motion.end"] = end
        omega = np.linspace(0, 4, 50)
        peak, lateral = inside / (0.01 + (omega - 2) ** 2), outside / (0.01 + (omega - 1) ** 2)
        still = {"upper": "lower", "lower": "upper"}[end]
        table(file, "/resonance", {"omega": omega, "tension": 1e3 * peak, f"tension_{end}": 9e2 * peak, f"tension_{still}": 5e2 * peak,
                                   "V": peak, "W": lateral})
        table(file, "/natural", {"omega": [2.0, 1.0], "plane": ["in_plane", "out_of_plane"]})
        w = np.sin(np.pi * line["x"] / 100)
        for name in ("w0.8", "w1.2"):
            T = 1e3 * inside * w
            columns = {**{f"{c}_phase": 0 * w for c in "UVW"}, "U": 0.1 * inside * w, "V": inside * w, "W": outside * w, "tension": T}
            table(file, f"/motions/{name}/h1", {**line, **columns})
            table(file, f"/motions/{name}/envelope", {**line, "static_tension": 6e3 + 0 * w, "total_max": 6e3 + T, "total_min": 6e3 - T})


def veering(path):
    with h5py.File(path, "w") as file:
        hanging(file, "veering")
        kappa = np.geomspace(1e-3, 0.1, 20)
        for h in ("0", "0.1"):
            table(file, f"/fan/h{h}", {"flexibility": kappa, "omega1": 2 + 0 * kappa, "omega2": 3 - 10 * kappa, "odd1": kappa > 0.01, "odd2": kappa < 0.01})
        table(file, "/approaches", {"height_over_span": [0.0, 0.1], "flexibility": [0.1, 0.1], "omega_lower": [2.0, 1.98], "omega_upper": [2.0, 2.02],
                                    "gap": [0.0, 0.02], "what": ["crossing", "veering"]})
        x = np.linspace(0, 1, 20)
        for stage in ("stiffer", "closest", "softer"):
            group = table(file, f"/hybrid/h0.1/{stage}", {"x": x, "V_lower": np.sin(np.pi * x), "V_upper": np.sin(2 * np.pi * x)})
            group.attrs.update({"flexibility": 0.01, "lower_mode": 1.0, "odd_lower": 0.1, "odd_upper": 0.9})


def test_hanging_cables(folder):
    for make, names in ((catenary_modes, ["modes", "sag", "short-waves", "tension"]), (catenary_forced, ["along", "resonance", "shape"]),
                        (veering, ["frequencies", "hybrid"])):
        path = os.path.join(folder, f"{make.__name__}.h5")
        make(path)
        done = plot(path)
        check(done.returncode == 0 and done.stderr == "", done.stderr)
        made = sorted(n for n in os.listdir(folder) if n.startswith(make.__name__ + "-"))
        check(made == sorted(f"{make.__name__}-{n}.{f}" for n in names for f in ("png", "pdf")), str(made))
        for n in made:
            (check_picture if n.endswith("png") else check_document)(os.path.join(folder, n))


def forced_figures(folder, **motion):
    """Figures of a made-up catenary-forced result by name: titles of their panels, legend, lines of each panel."""
    import figures_catenary_forced
    from result_file import read
    path = os.path.join(folder, "forced.h5")
    catenary_forced(path, **motion)
    done = plot(path, "--format", "png")
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    for name in ("along", "resonance", "shape"):
        check_picture(os.path.join(folder, f"forced-{name}.png"))
    return dict(figures_catenary_forced.figures(read(path)))


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_cable_forced_out_of_plane(folder):
    """Out of plane alone: W is drawn everywhere, with its own natural frequency; nothing of zeros, nothing in plane."""
    found = forced_figures(folder, inside=0.0, outside=1.0)
    axes = found["resonance"].axes
    check([a.get_ylabel() for a in axes] == ["W [m]"], str([a.get_ylabel() for a in axes]))
    check(np.isclose(np.max(axes[0].lines[0].get_ydata()), 100, rtol=0.2), "W in the resonance diagram")
    check([line.get_xdata()[0] for line in axes[0].lines[1:]] == [1.0], "natural frequency out of plane")
    check([a.get_ylabel() for a in found["along"].axes] == ["amplitude [m]", ""], "panels along the cable")
    check([a.get_ylabel() for a in found["shape"].axes] == ["W [m]", "W [m]"], "panels of the shape")
    check(np.max(found["shape"].axes[0].lines[1].get_ydata()) > 0.9, "W in the shape")
    for name, figure in found.items():
        words = " ".join(legend(figure))
        check("out of plane" in words and "tension" not in words and "normal" not in words and "in plane" not in words, f"{name}: {words}")


def test_cable_forced_in_and_out_of_plane(folder):
    found = forced_figures(folder, inside=1.0, outside=1.0)
    axes = found["resonance"].axes
    check([a.get_ylabel() for a in axes] == ["dynamic tension [kN]", "V [m]", "W [m]"], str([a.get_ylabel() for a in axes]))
    check([a.lines[-1].get_xdata()[0] for a in axes] == [2.0, 2.0, 1.0], "natural frequencies by plane")
    check("natural frequency in plane in (a), (b); out of plane in (c)" in legend(found["resonance"]), str(legend(found["resonance"])))
    check(len(found["along"].axes) == 6 and len(found["along"].axes[0].lines) == 3, "U, V and W along the cable")
    check([a.get_ylabel() for a in found["shape"].axes] == ["y [m]", "y [m]", "W [m]", "W [m]"], "side view and W")
    plain = forced_figures(folder)
    for name, figure in plain.items():
        check("out of plane" not in " ".join(legend(figure)), f"{name}: {legend(figure)}")


def test_cable_forced_at_its_lower_end(folder):
    """The tension at both ends, whichever moves."""
    for end in ("lower", "upper"):
        figure = forced_figures(folder, end=end)["resonance"]
        check({"at the lower end", "at the upper end"} <= set(legend(figure)), str(legend(figure)))
        largest = {line.get_color(): np.max(line.get_ydata()) for line in figure.axes[0].lines[:3]}
        colours = {t.get_text(): h.get_color() for t, h in zip(figure.legends[0].get_texts(), figure.legends[0].get_lines())}
        check(largest[colours[f"at the {end} end"]] > 1.5 * min(largest.values()), f"{end}: {largest}")
        check(end_named(figure, end), "the moved end stands above the figure")


def end_named(figure, end):
    return any(f"{end} end moved" in text.get_text() for text in figure.texts)


def test_cable_forced_not_at_all(folder):
    path = os.path.join(folder, "still.h5")
    catenary_forced(path, inside=0.0, outside=0.0)
    check_refused(folder, "still.h5", "every displacement and tension is zero")


def test_cable_modes_of_one_plane(folder):
    """The legend names what is there; without modes the message says so."""
    import figures_catenary_modes
    from result_file import read
    path = os.path.join(folder, "one.h5")
    for gone, there, absent in (("out_of_plane", "in plane", "out of plane"), ("in_plane", "out of plane", "in plane")):
        catenary_modes(path)
        with h5py.File(path, "r+") as file:
            del file[f"shapes/{gone}"]
        words = " ".join(legend(dict(figures_catenary_modes.figures(read(path)))["modes"]))
        check(there in words and absent not in words, words)
    with h5py.File(path, "r+") as file:
        for name in ("shapes", "modes", "sweep"):
            del file[name]
    check_refused(folder, "one.h5", "it has no modes")


def test_cable_modes_along_and_deep(folder):
    """A mode along the cable shows U across it; displacements of a deep cable are a share of its height."""
    import figures_catenary_modes
    from result_file import read
    path = os.path.join(folder, "deep.h5")
    catenary_modes(path)
    with h5py.File(path, "r+") as file:
        shape = file["shapes/in_plane/mode1"]
        shape["U"][:], shape["V"][:] = shape["V"][:], 0.1 * shape["V"][:]
    figure = dict(figures_catenary_modes.figures(read(path)))["modes"]
    first = figure.axes[0]
    check("longitudinal" in first.get_title(loc="left") and any("drawn across" in text for text in legend(figure)), str(legend(figure)))
    check(np.isclose(np.max(np.abs(first.lines[2].get_ydata() - first.lines[0].get_ydata())), 8, rtol=0.02), "U across the cable, 8 % of the span")
    catenary_modes(path)
    with h5py.File(path, "r+") as file:
        for mode in (1, 2):
            file[f"shapes/in_plane/mode{mode}/y"][:] *= 40  # 1000 m deep
    figure = dict(figures_catenary_modes.figures(read(path)))["modes"]
    rest, moved = figure.axes[1].lines[:2]
    largest = np.max(np.hypot(moved.get_xdata() - rest.get_xdata(), moved.get_ydata() - rest.get_ydata()))
    check(75 < largest < 85 and any("of the height" in text for text in legend(figure)), f"{largest}")


def test_hanging_cable_moved(folder):
    """Displacements turn with the cable: on a level stretch U is horizontal, on a rising one V leans back."""
    from catenary_parts import moved
    from result_file import Group
    x = np.linspace(0, 1, 5)
    for slope in (0.0, 1.0):
        line = Group(columns={"x": x, "y": slope * x, "U": 0 * x + 0.1, "V": 0 * x + 0.2})
        dx, dy = (a - b for a, b in zip(moved(line, ("U", "V"), 1.0), (x, slope * x)))
        c = 1 / np.hypot(1, slope)
        check(np.allclose(dx, c * (0.1 - slope * 0.2)) and np.allclose(dy, c * (slope * 0.1 + 0.2)), f"{dx} {dy}")


def periodic(path):
    """In plane, a whirling branch and one of period two; two orbits; a curve with a cusp."""
    with h5py.File(path, "w") as file:
        study(file, "periodic")
        file["study"].attrs["second.parameter"] = "support_motion.amplitude"
        omega = np.linspace(1, 2, 15)
        for name, A, period, unstable in (("IP1", 0.0, 1.0, omega > 1.5), ("W1", 1.0, 1.0, omega < 0), ("DW1", 0.4, 2.0, omega > 1.8)):
            columns = {"omega": omega, "n_unstable": unstable, "arclength": np.arange(15.0)}
            for q, size in (("q1", A), ("q2", 1.0)):
                columns[f"{q}_max"] = size * (omega - 0.9)
                for k in (0, 0.5, 1, 1.5, 2):
                    columns[f"{q}_h{k:g}"] = size * omega / (1 + k)
                    columns[f"{q}_h{k:g}_phase"] = 0 * omega
            for i, z in enumerate((0.9 * np.exp(1j * omega), 0.9 * np.exp(-1j * omega), 1.2 * unstable + 0.1, 0.3 + 0 * omega)):
                columns[f"mu{i + 1}_re"], columns[f"mu{i + 1}_im"] = np.real(z), np.imag(z)
            table(file, f"/branches/{name}", columns).attrs["period"] = period
        table(file, "/special_points", {
            "branch": ["IP1", "W1"], "label": ["PD1", "TR1"], "type": ["PD", "TR"], "subtype": ["", ""], "omega": [1.5, 1.7], "q1_max": [0.0, 0.8],
            "q2_max": [0.6, 0.8], "arclength": [7.0, 9.8], "unstable_before": [0, 0], "unstable_after": [1, 0],
            **{f"{q}_h{k:g}": [0.1, 0.2] for q in ("q1", "q2") for k in (0, 0.5, 1, 1.5, 2)}})
        for i, (name, stable) in enumerate((("W1", 1.0), ("IP1", 0.0))):
            group = table(file, f"/verification/motions/{i:03}", wave(1.65, 2, stable, 1.0, 65, True))
            group.attrs.update({"branch": name, "stable": stable, "period": 1.0, "omega": 1.65})
        U = np.linspace(0.3, 0.5, 9)
        for name, kind, at in (("PD1", "PD", 1.4 + U), ("TR2", "TR", 1.2 + U)):
            table(file, f"/curves/{name}", {"omega": at, "support_motion.amplitude": U, "coefficient": U - 0.4}).attrs.update({"type": kind, "subtype": ""})
        table(file, "/curve_points", {"curve": ["PD1", "TR2"], "type": ["R2", "MIN"], "omega": [1.75, 1.5], "support_motion.amplitude": [0.35, 0.3]})


def test_periodic_figures(folder):
    path = os.path.join(folder, "exact.h5")
    periodic(path)
    check_figures(path, ["response", "harmonics", "multipliers", "orbits", "chart"])


def compared(path):
    """Three levels, a sweep, three points of which two are alone, a map that is trusted up to its second row."""
    with h5py.File(path, "w") as file:
        study(file, "compare")
        file["study"].attrs["compare.tolerance"] = 0.1
        omega = np.linspace(1, 2, 11)
        for k, level in enumerate(("frozen", "complete", "exact")):
            branch(file, f"{level}-IP1", omega, 0.1 * k + 0 * omega, omega + 0.1 * k, omega > 1.6)
            file[f"branches/{level}-IP1"].attrs["level"] = level
        table(file, "/sweep/up", {"omega": omega, "q1_h2": 0 * omega, "q2_h2": omega})
        nan = float("nan")
        table(file, "/compare/points", {
            "kind": ["LP", "WH", "PD"], "branch": ["IP1"] * 3, "found": ["all", "only frozen", "only exact"], "omega_exact": [1.3, nan, 1.8],
            "omega_frozen": [1.4, 1.6, nan], "omega_complete": [1.31, nan, nan], "omega_integrated": [1.3, nan, nan]})
        x, y = np.meshgrid(omega, [0.1, 0.2, 0.3, 0.4])
        table(file, "/compare/map", {"omega": x.ravel(), "support_motion.amplitude": y.ravel(), "error": (0.4 * y * x).ravel(),
                                     "amplitude": x.ravel(), "same_kinds": (x < 1.8).astype(float).ravel()})
        file["compare"].attrs.update({"trusted_up_to": 0.2, "sentence": "trust the averaged curve below U = 0.2"})


def test_compare_figures(folder):
    path = os.path.join(folder, "levels.h5")
    compared(path)
    check_figures(path, ["response", "points", "map"], most=0.8)  # a map is coloured all over


def test_truncated(folder):
    path = os.path.join(folder, "whole.h5")
    superharmonic(path)
    with open(path, "rb") as file:
        content = file.read()
    os.unlink(path)
    for share in (0.9, 0.5, 0.1):
        with open(os.path.join(folder, "cut.h5"), "wb") as file:
            file.write(content[:int(share * len(content))])
        check_refused(folder, "cut.h5", "truncated")


def test_damaged(folder):
    path = os.path.join(folder, "damaged.h5")
    superharmonic(path)
    with open(path, "r+b") as file:
        file.seek(1000)
        file.write(b"\xff" * 3000)
    check_refused(folder, "damaged.h5", "")


def test_not_results(folder):
    os.mkdir(os.path.join(folder, "folder.h5"))
    check_refused(folder, "folder.h5", "directory")
    check_refused(folder, "missing.h5", "No such file")
    with open(os.path.join(folder, "text.h5"), "w") as file:
        file.write("omega = 1.5\n" * 100)
    check_refused(folder, "text.h5", "not an HDF5 file")
    open(os.path.join(folder, "empty.h5"), "w").close()
    check_refused(folder, "empty.h5", "empty")
    with h5py.File(os.path.join(folder, "alien.h5"), "w") as file:
        file["data"] = np.arange(3)
    check_refused(folder, "alien.h5", "not a result")
    with h5py.File(os.path.join(folder, "early.h5"), "w") as file:
        study(file, "superharmonic")
    check_refused(folder, "early.h5", "nothing to draw")


def test_missing_column(folder):
    path = os.path.join(folder, "lacking.h5")
    superharmonic(path)
    with h5py.File(path, "r+") as file:
        del file["branches/W1/q2_h2"]
    check_refused(folder, "lacking.h5", "/branches/W1/q2_h2")


def test_bad_command_line(folder):
    path = os.path.join(folder, "made-up.h5")
    superharmonic(path)
    for arguments in ([path, "--format", "gif"], [], [path, "-o", path]):
        done = plot(*arguments)
        check(done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr)
    check(os.listdir(folder) == ["made-up.h5"], "something was written")


def main():
    tests = [(name, test) for name, test in globals().items() if name.startswith("test_")]
    failed = 0
    for name, test in tests:
        try:
            with tempfile.TemporaryDirectory() as folder:
                test(folder)
        except Exception:
            failed += 1
            print(f"FAILED {name}\n{traceback.format_exc()}")
    print(f"{len(tests) - failed} passed, {failed} failed")
    return 1 if failed else 0


sys.exit(main())
