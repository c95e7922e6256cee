"""One peer on runs that were made for it: `python peer_script.py PEER INPUT.npz OUTPUT.npz`.

Runs in the peer's own environment, so it imports numpy and the peer only. INPUT has points (N, k)
and values (N, T) to fit at total degree `degree`, points `tested` (H, k) to predict at; for bounds
`line` (G,) and `curves` (G, n), the responses at n instants on a fine line of the one parameter."""

import sys
import time

import numpy as np


def chaospy(data):
    """Least squares of a polynomial chaos expansion, all instants at once."""
    import chaospy as peer

    k = data["points"].shape[1]
    start = time.perf_counter()
    joint = peer.J(*[peer.Uniform(-1, 1) for _ in range(k)])
    basis = peer.generate_expansion(int(data["degree"]), joint)
    model = peer.fit_regression(basis, data["points"].T, data["values"])
    seconds = time.perf_counter() - start
    predictions = np.stack([np.asarray(model(*point)) for point in data["tested"]])
    return {"seconds": seconds, "predicted": predictions, "version": peer.__version__}


def openturns(data):
    """Functional chaos with a fixed basis and least squares, all instants at once."""
    import openturns as peer

    k = data["points"].shape[1]
    start = time.perf_counter()
    uniform = peer.Uniform(-1, 1)
    basis = peer.OrthogonalProductPolynomialFactory(
        [peer.StandardDistributionPolynomialFactory(uniform)] * k, peer.LinearEnumerateFunction(k)
    )
    size = basis.getEnumerateFunction().getBasisSizeFromTotalDegree(int(data["degree"]))
    inputs, outputs = (peer.Sample(data[key].tolist()) for key in ("points", "values"))
    algorithm = peer.FunctionalChaosAlgorithm(
        inputs,
        outputs,
        peer.JointDistribution([uniform] * k),
        peer.FixedStrategy(basis, size),
        peer.LeastSquaresStrategy(),
    )
    algorithm.run()
    model = algorithm.getResult().getMetaModel()
    seconds = time.perf_counter() - start
    predictions = np.array(model(peer.Sample(data["tested"].tolist())))
    return {"seconds": seconds, "predicted": predictions, "version": peer.__version__}


def pyuncertainnumber(data):
    """Bounds at each instant by each method; the model is the interpolated curve, calls counted."""
    from importlib.metadata import version

    from pyuncertainnumber import pba
    from pyuncertainnumber.propagation import b2b as module

    methods = {
        "endpoints": {"interval_strategy": "endpoints"},
        "subinterval 4": {"interval_strategy": "subinterval", "n_sub": 4},
        "subinterval 32": {"interval_strategy": "subinterval", "n_sub": 32},
        "ga": {"interval_strategy": "ga"},
    }
    result = {"version": version("pyuncertainnumber")}
    for name, options in methods.items():
        if "n_sub" in options:
            options["subinterval_style"] = "endpoints"
        bounds, calls, start = [], [], time.perf_counter()
        instants = data["curves"].T[:1] if name == "ga" else data["curves"].T
        for curve in instants:
            model = CountedCurve(data["line"], curve)
            propagate = getattr(module, "b2b", module)
            # the endpoints take two variables or more (one has no width), ga takes a lone one
            box = [pba.I(-1, 1)] if name == "ga" else [pba.I(-1, 1), pba.I(0, 0)]
            interval = propagate(vars=box, func=model, **options)
            bounds.append([float(interval.lo), float(interval.hi)])
            calls.append(model.calls)
        key = name.replace(" ", "_")
        result[f"{key}_bounds"] = np.array(bounds)
        result[f"{key}_calls"] = np.mean(calls)
        result[f"{key}_seconds"] = (time.perf_counter() - start) / len(instants)
    return result


class CountedCurve:
    """A curve over the parameter that counts the different points at which it is asked for."""

    def __init__(self, line, curve):
        self.line, self.curve, self.points = line, curve, set()

    @property
    def calls(self):
        """Number of runs that the model would have cost."""
        return len(self.points)

    def __call__(self, x):
        x = np.atleast_2d(np.asarray(x, dtype=float))
        self.points.update(x[:, 0].tolist())
        return np.interp(x[:, 0], self.line, self.curve)


if __name__ == "__main__":
    with np.load(sys.argv[2]) as data:
        result = globals()[sys.argv[1]](dict(data))
    np.savez(sys.argv[3], **result)
