"""netCDF's classic format: what is written is what every library reads."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

from fpm.files.classic import NetcdfVariable, read, write

GRID = np.arange(12.0).reshape(3, 4)
ATTRIBUTES = {"title": "Grüße", "share": 0.1, "steps": 7, "many": 2**40, "yes": True, "empty": ""}
VARIABLES = {
    "x": NetcdfVariable(("x",), np.linspace(0, 1, 3), {"units": "m"}),
    "grid": NetcdfVariable(("x", "y"), GRID, {"units": "m", "long_name": "a grid"}),
    "turned": NetcdfVariable(("y", "x"), GRID.T, {}),
    "single": NetcdfVariable(("y",), np.arange(4, dtype=np.float32), {}),
    "odd": NetcdfVariable(("z",), np.arange(5, dtype=np.int8), {}),
    "name": NetcdfVariable(("y",), np.array(["a", "bc", "", "ü"]), {}),
    "when": NetcdfVariable(("event",), np.array([0.25, 0.5]), {"units": "s"}),
    "what": NetcdfVariable(("event",), np.array([3, -1], dtype=np.int32), {}),
    "opens": NetcdfVariable(("event",), np.array([1, 0], dtype=np.int8), {}),
}


@pytest.fixture
def path(tmp_path):
    write(tmp_path / "file.nc", ATTRIBUTES, VARIABLES)
    return tmp_path / "file.nc"


@pytest.mark.parametrize("engine", ["netcdf4", "scipy"])
def test_other_libraries_read_it(path, engine):
    with xr.open_dataset(path, engine=engine) as file:
        for name, (dims, values, attributes) in VARIABLES.items():
            assert file[name].dims == dims
            np.testing.assert_array_equal(file[name].values, values)
            assert file[name].attrs == attributes
            if values.dtype.kind != "U":
                assert file[name].dtype == values.dtype
        for name, value in ATTRIBUTES.items():
            assert file.attrs[name] == value


def test_it_reads_its_own_files(path):
    attributes, variables = read(path)
    assert attributes == ATTRIBUTES
    assert set(variables) == set(VARIABLES)
    for name, (dims, values, own) in VARIABLES.items():
        if values.dtype.kind == "U":
            found = [row.tobytes().rstrip(b"\0").decode() for row in variables[name].values]
            assert found == values.tolist()
        else:
            assert variables[name].dims == dims
            assert variables[name].attributes == own
            np.testing.assert_array_equal(variables[name].values, values)


def test_it_reads_what_the_c_library_writes(tmp_path):
    with netCDF4.Dataset(tmp_path / "c.nc", "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.createDimension("x", 3)
        file.createDimension("event", None)
        file.createVariable("x", "f8", ("x",))[:] = [1, 2, 3]
        for name in ("one", "two"):
            file.createVariable(name, "i2", ("event",))[:] = [4, 5]
        file.title = "from C"
    attributes, variables = read(tmp_path / "c.nc")
    assert attributes["title"] == "from C"
    assert variables["x"].values.tolist() == [1, 2, 3]
    assert variables["two"].values.tolist() == [4, 5]


def test_variables_without_values_are_left_out(tmp_path):
    variables = {
        "when": NetcdfVariable(("event",), np.zeros(0), {}),
        "hinge": NetcdfVariable(("hinge",), np.array([], dtype=str), {}),
        "opening": NetcdfVariable(("x", "hinge"), np.zeros((3, 0)), {}),
        "x": VARIABLES["x"],
    }
    write(tmp_path / "file.nc", {}, variables)
    with xr.open_dataset(tmp_path / "file.nc") as file:
        assert dict(file.sizes) == {"x": 3}
    assert set(read(tmp_path / "file.nc")[1]) == {"x"}


def test_a_file_that_was_cut_off_is_refused(path):
    whole = path.read_bytes()
    for size in (*range(0, len(whole) - 3, 7), len(whole) - 4):
        path.write_bytes(whole[:size])
        with pytest.raises(OSError, match=r"file\.nc is not a whole file"):
            read(path)


def test_names_of_any_letters_are_kept_and_read_by_other_libraries(tmp_path):
    variables = {"größe_φ": NetcdfVariable(("ζ",), np.arange(3.0), {"дом": "é"})}
    write(tmp_path / "run.nc", {"λ": "α", "1": 2}, variables)
    attributes, variables_there = read(tmp_path / "run.nc")
    assert attributes == {"λ": "α", "1": 2} and variables_there["größe_φ"].dims == ("ζ",)
    with xr.open_dataset(tmp_path / "run.nc", engine="netcdf4") as dataset:
        assert dataset["größe_φ"].dims == ("ζ",) and dataset["größe_φ"].attrs["дом"] == "é"
        assert dataset.attrs["λ"] == "α"
