"""CSV files as instruments and programs write them: each is read right, or refused with its line.

Every file holds the same three instants (0, 0.5, 1.25 s) and angles (0.5, -0.25, 1.125 rad)."""

import numpy as np
import pytest

from deployable.campaign.config.check import check_config
from fpm.structures.curves_file import CurvesFile, CurvesFileError

TIMES, ANGLES = [0.0, 0.5, 1.25], [0.5, -0.25, 1.125]
H = "t [s],angle [rad]\n"
R = "0,0.5\n0.5,-0.25\n1.25,1.125\n"
DEGREES = [f"{t},{np.degrees(a):.12f}\n" for t, a in zip(TIMES, ANGLES, strict=True)]
DEG = "".join(DEGREES)
SEMI = "t [s];angle [rad]\n"
COMMA = "0,0;0,5\n0,5;-0,25\n1,25;1,125\n"


def milli(factor, digits=1):
    """Rows with times in another unit."""
    return "".join(f"{t * factor:.{digits}f},{a}\n" for t, a in zip(TIMES, ANGLES, strict=True))


RIGHT = {
    "byte order mark": "\ufeff" + H + R,
    "CR": (H + R).replace("\n", "\r"),
    "UTF-16": (H + R).encode("utf-16"),
    "Latin 1 degrees": f"t [s],angle [°]\n{DEG}".encode("latin-1"),
    "semicolons and points": SEMI + R.replace(",", ";"),
    "semicolons and decimal commas": SEMI + COMMA,
    "decimal commas of powers": SEMI + "0,000e0;5,000e-1\n5,000e-1;-2,500e-1\n1,250e0;1,125E0\n",
    "tabs and decimal commas": (SEMI + COMMA).replace(";", "\t"),
    "aligned spaces": "  t [s]  angle [rad]\n  " + R.replace(",", "   ").replace("\n", "\n  "),
    "spaces and decimal commas": "t [s] angle [rad]\n" + COMMA.replace(";", " "),
    "spaces, units below": "t angle\ns rad\n" + R.replace(",", " "),
    "sep line of a spreadsheet": "sep=;\n" + SEMI + R.replace(",", ";"),
    "DIN slash with spaces": "t / s,angle / rad\n" + R,
    "DIN brackets": "t/(s),angle/(rad)\n" + R,
    "sec": "Time (sec),angle (rad)\n" + R,
    "micro sign": "t [µs],angle [rad]\n" + milli(1e6),
    "ns": "t [ns],angle [rad]\n" + milli(1e9, 0),
    "minutes": "t [min],angle [rad]\n" + milli(1 / 60, 15),
    "Deg": "t [s],angle [Deg]\n" + DEG,
    "turns": "t [s],angle [rev]\n"
    + "".join(f"{t},{a / 2 / np.pi:.15f}\n" for t, a in zip(TIMES, ANGLES, strict=True)),
    "row of units in brackets": "t,angle\n[s],[rad]\n" + R,
    "row of units with text": "t,angle,note\n(s),(rad),-\n" + R.replace("\n", ",ok\n"),
    "comments within": H + R.replace("\n0.5", "\n# trigger\n0.5"),
    "names in a comment": "# bench 3\n# t [s],angle [rad]\n" + R,
    "all quoted": '"t [s]","angle [rad]"\n"0","0.5"\n"0.5","-0.25"\n"1.25","1.125"\n',
    "quoted decimal commas": H + '"0,0","0,5"\n"0,5","-0,25"\n"1,25","1,125"\n',
    "an index without name": ",t [s],angle [rad]\n0,0,0.5\n1,0.5,-0.25\n2,1.25,1.125\n",
    "the time last": "angle [rad],t [s]\n0.5,0\n-0.25,0.5\n1.125,1.25\n",
    "a symbol like a unit": "t/s,s/mm,angle/rad\n" + R.replace(",", ",7,"),
    "text with commas": "t [s],angle [rad],note\n" + R.replace("\n", ',"a, b; c"\n'),
    "an empty column": "t [s],angle [rad],\n" + R.replace("\n", ",\n"),
    "commas at the ends of rows": H + R.replace("\n", ",\n"),
    "empty columns in the head alone": "t [s];angle [rad];;\n" + COMMA,
    "separators at the ends of some rows": SEMI + COMMA.replace("\n", ";;\n", 1),
    "empty rows of a sheet": SEMI + COMMA.replace("\n", ";;\n") + ";;;\n ; ;\n",
    "a column of an unknown unit": "t [s],raw [counts],angle [rad]\n" + R.replace(",", ",7,"),
    "blank lines": "\n" + H + "\n" + R.replace("\n0.5", "\n\n0.5") + "\n\n",
    "powers of Fortran": H + "0D0,5.0D-1\n5d-1,-25D-2\n1.25D+00,1.125D0\n",
    "signs and bare points": H + "+0.,+.5\n.5,-.25\n1.25,1.125\n",
    "a minus of typesetters": H + R.replace("-", "−"),
    "three decimals beside semicolons": SEMI + "0.000;0.500\n0.500;-0.250\n1.250;1.125\n",
    "a version with points": "t [s];angle [rad];firmware\n"
    + R.replace(",", ";").replace("\n", ";1.234.567\n"),
    "dates beside decimals": "t [s];angle [rad];day\n"
    + R.replace(",", ";").replace("\n", ";28.11.2026\n"),
    "thousands": '"t [ms]","angle [rad]"\n"0.0",0.5\n"500.0",-0.25\n"1,250.0",1.125\n',
    "points between thousands": "t [ms];angle [rad]\n0,0;0,5\n500,0;-0,25\n1.250,0;1,125\n",
    "Adams": '"Time"\t"angle"\n"(sec)"\t"(rad)"\n' + R.replace(",", "\t"),
    "Ansys": "\tTime [s]\tangle [rad]\n1\t0.\t0.5\n2\t0.5\t-0.25\n3\t1.25\t1.125\n",
    "comments of Matlab": "% bench\n" + H + "0,0.5\n% trigger\n0.5,-0.25\n1.25,1.125\n",
    "comments of MTi": "// Start Time: Unknown\n// Sample rate: 100.0Hz\n" + H + R,
    "comment at the end": H + R + "# end of record\n",
    "two returns": (H + R).replace("\n", "\r\r\n"),
    "mrad": "t [s],angle [mrad]\n0,500\n0.5,-250\n1.25,1125\n",
    "us without spaces": "t(us),angle(rad)\n" + milli(1e6),
    "units after a blank line": "t,angle\n\n[s],[rad]\n" + R,
    "no-break spaces in names": "t\u00a0[s],angle\u00a0[rad]\n" + R,
    "names that differ by a capital": "t [s],Angle [m],angle [rad]\n" + R.replace(",", ",9,"),
    "temperature beside the time": "T [degC],t [s],angle [rad]\n"
    + "".join(f"20,{row}\n" for row in R.split()),
    "errors of a sheet beside the time": "T;t [s];angle [rad]\n#WERT!;0;0,5\n"
    "#¡VALOR!;0,5;-0,25\n####;1,25;1,125\n",
    "signs of comments in quotes": "no,t [s],angle [rad]\n" + '"#1",0,0.5\n"%",0.5,-0.25\n'
    '"//a",1.25,1.125\n',
    "comments of text with separators": H + R.replace("\n", "\n# stopped, then restarted\n", 1),
    "the same times twice": "t [s],angle [rad],t [ms]\n0,0.5,0\n0.5,-0.25,500\n1.25,1.125,1250\n",
    "a time for each channel": "time1 [s],angle [rad],time2 [s],x [mm]\n"
    "0,0.5,0,1\n0.5,-0.25,0.5,2\n1.25,1.125,1.25,3\n",
    "names over two lines": '"t\n[s]","angle\n[rad]"\n' + R,
    "a ratio": "t [s],ratio [-],angle [rad]\n" + R.replace(",", ",7,"),
    "whole numbers of a column with a unit at the end": "t [s],angle [rad],cycle [-]\n"
    + R.replace("\n", ",7\n"),
    "an empty column before a note": "t [ms],angle [mrad],F [N],n\n"
    "0,500,,2\n500,-250,,2\n1250,1125,,\n",
    "spaces behind commas and whole numbers": "t [ms],angle [mrad],n\n"
    "0, 500, 2\n500, -250, 2\n1250, 1125, 2\n",
    "whole numbers of a column with an unknown unit at the end": "t [ms],angle [mrad],T [°C]\n"
    "0,500,20\n500,-250,21\n1250,1125,21\n",
    "rows of separators at both ends": "t [s],angle [rad]\n,\n" + R + ",\n,\n",
}

REFUSED = {
    "empty": ("", "line 1: '' is not a line of names"),
    "names alone": (H, "no rows; allowed"),
    "no names": (R, "line 1: no line of names with units stands above"),
    "two units of time": ("t [s] (ms),angle [rad]\n" + R, "has no column with a unit of time"),
    "time in ms and s": ("t/ms [s],angle [rad]\n" + R, "has no column with a unit of time"),
    "lines above without #": ("Operator: N.N.\n" + H + R, "line 1: 'Operator: N.N.' has no column"),
    "no curve": ("t [s]\n0\n1\n", "line 1: there is no column beside the time"),
    "a lone 1,234": (SEMI + "0;1,234\n1;2,345\n", "line 2: '1,234' could be 1.234 or 1234"),
    "a lone 1.234 beside semicolons": (
        SEMI + "0;999\n1;1.000\n", "line 3: '1.000' could be 1.000 or 1000; allowed: decimal poi"
    ),
    "both commas": (SEMI + "0,5;0\n1;1,234.5\n", "line 2: '0,5' has a decimal comma, and"),
    "commas and decimal commas": (H + "0,0,0,5\n", "line 2: 4 values (decimal commas need semico"),
    "a column without a name": (H + R.replace("\n", ",7\n"), "line 2: 3 values (does the f"),
    "a footer": (H + R + "END\n", "line 5: 'END' is not allowed; allowed: a finite number"),
    "a time that is missing": (H + R + ",7\n", "line 5: the cell of t is empty; allowed: a"),
    "a time twice": (H + "0,1\n0,1\n", "line 3: the time 0 s does not follow 0 s; allowed: incre"),
    "times that decrease": (H + "1,1\n0.5,1\n", "line 3: the time 0.5 s does not follow 1 s"),
    "dates": (H + "2026-11-28T04:00:00,1\n", "allowed: seconds since the start"),
    "quotes left open": (H + '0,"0.5\n', "line 2: quotes do not close where they open; allo"),
    "rows of errors alone": (H + R + "#WERT!,#WERT!\n", "line 5: '#WERT!' is not allowed; allowed"),
    "paths of a network": (
        "file,t [s],angle [rad]\n//a,0,0.5\n//b,0.5,1\n", "line 2: '//a' could begin a comment"
    ),
    "a row made a comment": (H + R.replace("\n", "\n#0.2,9\n", 1), "line 3: '#0.2' could begin a "),
    "an empty cell between spaces": (
        "t[s]  angle[rad]  x[m]\n0  0.5  9\n0.5        4\n1.25  1  9\n",
        "line 3: 2 values; allowed: 3, as in line 1",
    ),
    "a row of separators in the middle": (
        H + R.replace("\n", "\n,\n", 1), "line 3: the cell of t is empty; allowed: a finite number"
    ),
    "zero bytes": ((H + R).replace("1", "\0"), "it is not UTF-8 text"),
    "clock times": (H + "00:00:00,0.5\n", "line 2: '00:00:00' is not allowed; allowed: seconds si"),
    "a delay, and a time without a unit": (
        "time,delay [s],angle [rad]\n0,0.1,1\n1,0.2,2\n",
        "line 1: the time could be delay (column 2, 0.1 to 0.2 s) or time (column 1); allowed: ",
    ),
    "other times for each channel": (
        "Zeit [s],angle [rad],Zeit [s],x [m]\n0,1,0,1\n1,2,3,4\n",
        "the time could be Zeit (column 1, 0 to 1 s) or Zeit (column 3, 0 to 3 s)",
    ),
    "a shorter channel": (
        "time1 [s],angle [rad],time2 [s],x [m]\n0,1,0,1\n1,2,,\n",
        "line 1: the time could be time1 (column 1, 0 to 1 s) or time2 (column 3); allowed: ",
    ),
    "apostrophes": (
        "t [ms];angle [rad]\n0;1\n1'250;1\n",
        'line 3: "1\'250" is not allowed; allowed: the number without the sign between thousands',
    ),
    "decimal commas and a column without a name": (
        "t [ms],angle [rad],\n0,1,5\n10,2,5\n20,-3,25\n30,7\n",
        "line 2: '1,5' could be 1.5 or two numbers; allowed: decimal commas in ",
    ),
    "decimal commas and a note": (
        "t [ms],angle [rad],note\n0,1\n10,2,5e-1\n", "line 3: '2,5e-1' could be 2.5e-1 or two n"
    ),
    "times with decimal commas and a note": (
        "t [s],angle [rad],note\n0,5,-3\n1,25,4\n", "line 2: '0,5' could be 0.5 or two numbers; "
    ),
    "two decimal commas and two notes": (
        "t [s],angle [rad],note,by\n0,5,-3,25\n1,5,-4,75\n", "line 2: '0,5' could be 0.5 or two n"
    ),
    "decimal commas and a note on words": (
        "t [ms],angle [rad],seen (by hand)\n0,1,5\n", "line 2: '1,5' could be 1.5 or two numbers"
    ),
    "decimal commas without a heading": (
        "t [ms],angle [rad]\n0,1,5\n", "line 2: 3 values (decimal commas need semicolons betwee"
    ),
    "rows with names, as of R": (
        '"t [s]" "angle [rad]"\n"1" 0 0.5\n"2" 1 2\n',
        "line 2: 3 values (does the first column have no heading? Write its name); allowed: 2",
    ),
    "a workbook": (b"PK\3\4" + b"\0" * 9, "it is a workbook (.xlsx) or an archive; allowed: a CS"),
    "a compressed file": (b"\x1f\x8b\x08\0", "it is compressed (.gz); allowed: a CSV file in UTF"),
    "quoted thousands": ('t [ms],angle [rad]\n0,1\n"1,250",1\n', "line 3: '1,250' could be 1.250"),
    "descriptions below names": ("t,angle\ntime,hinge\ns,rad\n" + R, "line 1: 't,angle' has no co"),
    "a line of dashes": ("t [s]  angle [rad]\n-----  -----\n0 0.5\n", "line 2: '-----' is not all"),
    "names that do not close": ('"t\n[s],angle [rad]\n' + R, "line 1: quotes do not close where"),
    "columns that touch": ("t [s] angle [rad]\n0.0E+00-0.5E+00\n", "line 2: 1 values; allowed: 2"),
    "UTF-16 without its mark": (
        (H + R).encode("utf-16-le"), "it is not UTF-8 text (perhaps UTF-16 without a byte order"
    ),
    "the end of a file of DOS": (H + R + "\x1a", "line 5: '\\x1a' is not allowed"),
    "tonnes or time": ("x [t],angle [rad]\n" + R, "line 1: 'x [t],angle [rad]' has no column with"),
    "another separator than sep": ("sep=,\n" + SEMI + R, "line 2: 't [s];angle [rad]' has no colu"),
    "short rows": (H + "0\n1\n", "line 2: 1 values; allowed: 2, as in line 1"),
}  # fmt: skip

UNUSABLE = {  # files with a time, whose column `angle` cannot be used
    "m/s or 1/ms": ("t [s],angle [ms-1]\n" + R, "'ms-1' could be m/s or 1/ms"),
    "1.234 among commas": (SEMI + "0,5;1.234\n", "line 2: '1.234' could be 1.234 or 1234 beside '"),
    "1,23 among thousands": (SEMI + "1,234.5;1\n1,235.5;1,2345.6\n", "line 3: '1,2345.6' could be"),
    "1.234 among points between thousands": (
        "t [s];angle [rad];n [m]\n0;1.234;1.234.567\n1;2.345;2.345.678\n",
        "line 2: '1.234' could be 1.234 or 1234 beside '1.234.567' in line 2",
    ),
    "nan": (H + R + "2,nan\n", "line 5: 'nan' is not allowed; allowed: a finite number"),
    "a value missing": (H + "# x\n" + R + "2,\n", "line 6: the cell of angle is empty; allowed: a"),
    "a short first row": (H + "0\n0.5,1\n", "line 2: the cell of angle is empty"),
    "Grad": (
        "t [s],angle [Grad]\n" + R,
        "'Grad' is not a unit (did you mean deg?)",
    ),
    "turns or radians": ("t [s],angle [1/min]\n" + R, "'1/min' could be a speed (rpm) or a frequ"),
    "fused": ("t [s],angle [Nms/rad]\n" + R, "(did you mean N ms/rad or N m s/rad?)"),
    "plural": ("t [s],angle [rads]\n" + R, "'rads' is not a unit (did you mean rad or rad s?)"),
    "pounds": ("t [s],angle [in-lb]\n" + R, "could be a mass (kg) or a force (lbf); allowed"),
    "underscores": (
        H + R + "2,1_000\n",
        "line 5: '1_000' is not allowed; allowed: the number with",
    ),
    "narrow spaces between thousands": (
        SEMI + "0;1\u202f234,5\n",
        "allowed: the number without the sign between thousands",
    ),
    "a name twice": ("t [s],angle [rad],angle [deg]\n0,1,2\n", "the column angle stands twice"),
    "a unit without brackets": ("t [s],angle m/s\n" + R, "angle m/s: it has no unit; allowed"),
    "two units": ("t [s],angle [deg] (rad)\n" + R, "'angle [deg] (rad)' has two units; allowed"),
    "gravity": ("t [s],angle [g]\n" + R, "'g' could be a mass (kg) or an acceler"),
    "an error of a sheet among values": (H + R + "2,#VALUE!\n", "line 5: '#VALUE!' is not allowed"),
    "hexadecimal": (H + "0,0x1F\n", "line 2: '0x1F' is not allowed; allowed: a finite number"),
}


def read(folder, content):
    path = folder / "curves.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return CurvesFile.read(path)


@pytest.mark.parametrize("content", RIGHT.values(), ids=RIGHT)
def test_a_shape_is_read_right(tmp_path, content):
    file = read(tmp_path, content)
    np.testing.assert_allclose(file.times, TIMES, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(file.columns["angle"], ANGLES, rtol=1e-11)


@pytest.mark.parametrize(("content", "words"), REFUSED.values(), ids=REFUSED)
def test_a_shape_is_refused_with_line_and_remedy(tmp_path, content, words):
    with pytest.raises(CurvesFileError) as error:
        read(tmp_path, content)
    assert words in str(error.value) and "; allowed: " in str(error.value)


@pytest.mark.parametrize(("content", "words"), UNUSABLE.values(), ids=UNUSABLE)
def test_a_column_that_cannot_be_used_says_why(tmp_path, content, words):
    file = read(tmp_path, content)
    ((name, fault),) = file.faults.items()
    assert name not in file.columns and words in fault
    assert "; allowed: " in fault


@pytest.mark.parametrize(("name", "is_odd"), [
    ("t", 0), ("Time", 0), ("Zeit 1", 0), ("Elapsed Time", 0), ("dwell", 1), ("test", 1),
    ("dwell time", 1), ("tempo_2", 0), ("trigger", 1),
])  # fmt: skip
def test_a_time_with_an_odd_name_is_questioned(tmp_path, name, is_odd):
    file = read(tmp_path, f"cycle,{name} [ms],M [N m]\n0,10,1.5\n1,20,2.5\n")
    text = f"the time in {tmp_path / 'curves.csv'} is the column `{name}`: if this is right, call "
    assert [text in doubt for doubt in file.doubts] == [True] * is_odd


@pytest.mark.parametrize(("head", "used", "faulty"), [
    ("t [s],x (min),x (max)", [], ["x (min)", "x (max)"]),  # no minutes
    ("t [s],F (in),F (out)", [], ["F (in)", "F (out)"]),  # no inches
    ("t [s],x (in),y (mm)", ["x", "y"], []),
    ("t,x,temp\ns,mm,°C", ["x"], ["temp"]), ("t,x,load\nms,mm,%", ["x"], ["load"]),
])  # fmt: skip
def test_words_in_brackets_and_units_of_unused_columns(tmp_path, head, used, faulty):
    file = read(tmp_path, f"{head}\n0,1.5,20\n1,2.5,30\n")
    assert ([*file.columns], [*file.faults]) == (used, faulty)


@pytest.mark.parametrize(("symbol", "si"), [
    ("kNm", 1e3), ("mNm", 1e-3), ("N-m", 1), ("N.m", 1), ("Nm/°", 180 / np.pi), ("Ncm", 0.01),
    ("kgm²", 1), ("kg.mm2", 1e-6), ("deg/Nm", np.pi / 180), ("mm/min", 1e-3 / 60),
    ("in²", 0.0254**2), ("in-lbf", 0.0254 * 4.4482216152605), ("km/h", 1 / 3.6),
    ("deg/sec^2", np.pi / 180), ("m·s⁻²", 1), ("mdeg", np.pi / 180e3), ("usec", 1e-6),
    ("U/min", 2 * np.pi / 60), ("daN", 10), ("g/cm3", 1e3), ("in.", 0.0254), ("Ns/m", 1),
])  # fmt: skip
def test_a_unit_of_instruments_is_converted(tmp_path, symbol, si):
    file = read(tmp_path, f"t [s];x [{symbol}]\n0;2\n1;3\n")
    np.testing.assert_allclose(file.columns["x"], [2 * si, 3 * si], rtol=1e-14)


def test_names_with_spaces_and_times_before_0(tmp_path):
    name = "/Root/Bench 3/Encoder CH01"
    file = read(tmp_path, f"t [s],{name} [mm]\n-0.5,1\n0,2\n0.5,3\n")
    assert file.times.tolist() == [-0.5, 0, 0.5]
    assert file.columns[name].tolist() == [0.001, 0.002, 0.003]


@pytest.mark.parametrize(("times", "fitting", "odd"), [
    (range(0, 2000, 100), 50, 1), ((0, 500, 1000), 20, 1), ((-2, -1.5, -1), None, 1),
    ((1700000000, 1700000001), None, 1), ((-1, 0.5), 1, None), ((0, 5), 1, None),
    ((0, 1000), None, 1), ([k / 1e4 for k in range(20)], 0.1, 1), (range(-1500, 0, 50), None, 10),
    ([k / 2000 for k in range(21)], 5, 10),  # a pulse, which may be short
])  # fmt: skip
def test_a_record_that_runs_hardly_reach_is_questioned(tmp_path, times, fitting, odd):
    rows = "".join(f"{time},{k % 2}\n" for k, time in enumerate(times))
    (tmp_path / "push.csv").write_text("dwell [s],F [N]\n" + rows)
    (tmp_path / "arm.yaml").write_text(
        "parameters: {k: {value: 1, unit: N m/rad}}\npoints: {O: [0, 0, 0], C: [1, 0, 0]}\n"
        "bodies: {arm: {mass: 1, centre: C, points: [O], inertia: [1, 1, 1]}}\n"
        "joints: {hinge: {type: revolute, parts: [ground, arm], at: O, axis: y}}\n"
        "curves: {push: {file: push.csv, column: F}}\n"
        "loads: {push: {part: arm, at: C, force: [1, 0, 0], curve: push}}\n"
        "actions: {spring: {type: torsion spring, joint: hinge, stiffness: k, rest: 0 deg}}\n"
    )
    for duration, expected in filter(all, ((fitting, [False]), (odd, [True]))):
        campaign = check_config({
            "campaign": "c", "scene": {"file": str(tmp_path / "arm.yaml")},
            "solver": {"duration": duration}, "intervals": {"k": {"relative": 0.1}},
            "responses": {"phi": {"opening": "hinge"}},
        })  # fmt: skip
        words = (
            f"values lasts from {times[0]:.12g} to {times[-1]:.12g} s: check the unit of its times"
        )
        assert [any(words in text for text in campaign.experiment.warnings)] == expected
        assert any(
            "push.csv is the column `dwell`" in text for text in campaign.experiment.warnings
        )
