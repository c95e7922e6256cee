"""The package stands alone and is light to import."""

import subprocess
import sys

from deployable import intervals


def test_import_is_light_and_knows_nothing_of_the_mechanics():
    code = (
        "import sys, deployable.intervals\n"
        "heavy = {'scipy.linalg', 'scipy.spatial', 'scipy.stats', 'xarray', 'numba', 'matplotlib',"
        " 'fpm', 'deployable.campaign'}\n"
        "sys.exit(' '.join(heavy & set(sys.modules)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_errors_cross_process_borders():
    import pickle

    error = pickle.loads(pickle.dumps(intervals.IntervalError("order", 0, "at least 1")))
    assert (error.key, error.value, error.allowed) == ("order", 0, "at least 1")
    assert "0" in str(error)
