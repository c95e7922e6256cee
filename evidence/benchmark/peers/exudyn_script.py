"""A structure in Exudyn: a script for the interpreter that has Exudyn, whatever its version.

Reads {"structure": ..., "duration": s, "instants": n, "runs": [...]} from the file
named in its first argument, and prints one JSON object per run, with the places of the structure's
named points at the instants. The compiled module without range checks is taken."""

import json
import sys
import time

sys.exudynFast = True

import exudyn as exu  # noqa: E402
import numpy as np  # noqa: E402
import spatial_exudyn_script  # noqa: E402
from exudyn import itemInterface as item  # noqa: E402


def run(task, options):
    """Cpu seconds of building and solving, and the places (m) of the points at the instants."""
    start = time.process_time()
    explicit, step, duration = "solver" in options, options["step"], task["duration"]
    exu.config.printToConsole = False
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    points = spatial_exudyn_script.build(mbs, task["structure"], explicit)
    position = exu.OutputVariableType.Position
    sensors = {
        name: mbs.AddSensor(
            item.SensorMarker(markerNumber=point, outputVariableType=position, storeInternal=True)
        )
        for name, point in points.items()
    }
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(duration / step)
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.stepInformation = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = duration / (task["instants"] - 1)
    linear = options.get("linear", "EigenSparse")
    settings.linearSolver.solverType = getattr(exu.LinearSolverType, linear)
    settings.parallel.numberOfThreads = 1
    settings.timeIntegration.newton.useModifiedNewton = options.get("modified", True)
    settings.timeIntegration.generalizedAlpha.spectralRadius = options.get("radius", 0.9)
    if explicit:
        kind = getattr(exu.DynamicSolverType, options["solver"])
    else:
        kind = exu.DynamicSolverType.GeneralizedAlpha
    solver_start = time.process_time()
    success = mbs.SolveDynamic(settings, solverType=kind)
    cpu = time.process_time() - solver_start
    curves = {name: mbs.GetSensorStoredData(sensor) for name, sensor in sensors.items()}
    times = np.linspace(0, duration, task["instants"])
    places = {
        name: np.column_stack([np.interp(times, rows[:, 0], x) for x in rows[:, 1:].T]).tolist()
        for name, rows in curves.items()
    }
    return {
        "ok": bool(success) and all(np.isfinite(rows).all() for rows in curves.values()),
        "cpu": cpu,
        "building": solver_start - start,
        "steps": round(duration / step),
        "points": places,
        "version": exu.__version__,
    }


def main(path):
    with open(path) as file:
        task = json.load(file)
    for options in task["runs"]:
        try:
            result = run(task, options)
        except Exception as error:  # Exudyn reports a failed step by several kinds
            result = {"ok": False, "error": str(error)[:300]}
        print(json.dumps({**options, **result}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
