#!/usr/bin/python3
"""What `whirl` prints: JSON that a strict parser takes for every kind, tables on standard output, nothing told under two meanings, nothing hidden.

    WHIRL_PROGRAM=build/studies/whirl tests/test_json_output.py [test...]
"""
import csv, json, math, os, subprocess, sys, tempfile

import h5py

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("WHIRL_PROGRAM", os.path.join(HERE, "..", "build", "studies", "whirl"))
# what makes the input that `whirl init KIND` prints a matter of seconds
BRIEF = {
    "superharmonic": ["continuation.range=[1.55,1.7]", "verification.enabled=false"],
    "continuation": [],
    "cycles": ["cycles.period_doublings=0"],
    "two-parameter": [],
    "periodic": ["continuation.range=[1.5,1.6]", "seeds.grid=3"],
    "slow-flow": ["continuation.range=[1.6,1.65]", "verification.enabled=false", "seeds.max_periods=0"],
    "compare": ["continuation.range=[1.5,1.7]", "sweep.points=0", "map.values=[]"],
    "integrate": ["integrate.omega=[1.65]", "integrate.starts=[3.0,0.0]", "sweep.range=[]"],
    "basins": ["basins.resolution=[6,6]"],
    "modes": [],
    "mode-convergence": ["convergence.counts=[1]"],
    "catenary-modes": [],
    "catenary-forced": ["response.points=20", "response.refine=false", "response.at=[1.0]", "response.places=[0.0,50.0]"],
    "veering": ["veering.points=10"],
    "guy-statics": ["group.guys=3", "group.directions_deg=[0.0,30.0]"],
    "guy-modes": ["modes.count=3"],
    "guy-stiffness": ["stiffness.points=20", "stiffness.at=[0.5,1.0]"],
}


def check(condition, words):
    if not condition:
        raise AssertionError(words)


def once(pairs):
    keys = [key for key, _ in pairs]
    check(len(set(keys)) == len(keys), f"keys twice in {keys}")
    return dict(pairs)


def refuse(word):
    raise AssertionError(f"{word} is no JSON")


def strict(text):
    return json.loads(text, object_pairs_hook=once, parse_constant=refuse)


def whirl(folder, *arguments):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=300)


def run(folder, text, *overrides, status=0):
    """-> (what --json prints, the result file's path)"""
    with open(os.path.join(folder, "my.toml"), "w") as file:
        file.write(text)
    done = whirl(folder, "run", "my.toml", "--json", "-q", "-o", "r.h5", *[word for each in overrides for word in ("--set", each)])
    check(done.returncode == status, f"status {done.returncode}: {done.stderr}")
    return strict(done.stdout), os.path.join(folder, "r.h5")


def close(a, b, within=1e-12):
    return math.isclose(a, b, rel_tol=within, abs_tol=within)


def every_kind_prints_strict_json(folder):
    kinds = [line.split()[0] for line in whirl(folder, "list").stdout.splitlines()]
    check(set(kinds) == set(BRIEF), f"kinds without a brief input: {set(kinds) ^ set(BRIEF)}")
    for kind in kinds:
        told, path = run(folder, whirl(folder, "init", kind).stdout, *BRIEF[kind])
        check(told["kind"] == kind and told["outcome"] == "complete", f"{kind}: {told['kind']}, {told['outcome']}")
        check(isinstance(told["warnings"], list) and isinstance(told["stop_reasons"], list), kind)
        tables_are_those_of(told, path, kind)


def tables_are_those_of(told, path, kind):
    """Every group of columns in the file is a table of the JSON, short ones with their values."""
    with h5py.File(path, "r") as file:
        groups = {}
        file.visititems(lambda name, node: groups.setdefault("/" + name.rpartition("/")[0], {}).update({name.rpartition("/")[2]: node})
                        if isinstance(node, h5py.Dataset) and node.ndim == 1 else None)
        check(groups and {t["name"] for t in told["tables"]} == set(groups), f"{kind}: tables {[t['name'] for t in told['tables']]}")
        for table in told["tables"]:
            columns = groups[table["name"]]
            check({c["name"] for c in table["columns"]} == set(columns), f"{kind}: columns of {table['name']}")
            for c in table["columns"]:
                node = columns[c["name"]]
                check(len(node) == table["rows"], f"{kind}: rows of {table['name']}")
                check(c.get("unit") == node.attrs.get("units"), f"{kind}: unit of {table['name']}/{c['name']}")
                check(("values" in c) == (table["rows"] <= 200), f"{kind}: values of {table['name']}")
                values = [v.decode() if isinstance(v, bytes) else None if not math.isfinite(v) else v for v in node[()]]
                check(c.get("values", values) == values, f"{kind}: {table['name']}/{c['name']}")


def tables_go_to_standard_output(folder):
    for kind in ("modes", "catenary-modes", "guy-statics", "continuation"):
        with open(os.path.join(folder, "my.toml"), "w") as file:
            file.write(whirl(folder, "init", kind).stdout)
        done = whirl(folder, "run", "my.toml", "-o", "r.h5")
        check(done.returncode == 0 and done.stdout.count("\n") > 2, f"{kind}: {done.stderr}")
        check(all(line.startswith(("warning: ", "result: ")) for line in done.stderr.splitlines()), f"{kind}: {done.stderr}")
        check(whirl(folder, "run", "my.toml", "-q", "-o", "r.h5").stdout == "", kind)


def names_of_any_letters(folder):
    text = """study = "periodic"
[modal_model]
frequency = [1.0, 1.0]
damping = [0.02, 0.02]
mirror_subtype = 'a"b\\c'
term = [{equation = 1, coefficient = 1.0, powers = [1, 2]}, {equation = 2, coefficient = 1.0, powers = [0, 3]},
        {equation = 1, coefficient = 1.0, powers = [3, 0]}, {equation = 2, coefficient = 1.0, powers = [2, 1]}]
force = [{equation = 2, amplitude = 0.05, harmonic = 1}]
[continuation]
parameter = "omega"
range = [0.9, 1.4]
[seeds]
grid = 3
"""
    told, _ = run(folder, text)
    check('a"b\\c' in [p["subtype"] for p in told["special_points"]], str([p["subtype"] for p in told["special_points"]]))


def frequency_means_one_thing(folder):
    """Hopf points of an averaged stay: Hz of the excitation, and the imaginary part of the critical eigenvalue beside it."""
    stay = open(os.path.join(HERE, "..", "studies", "oresund-superharmonic.toml")).read()
    told, path = run(folder, stay, "verification.enabled=false")
    hopf = [p for p in told["special_points"] if p["type"] == "HB"]
    check(hopf, "no Hopf point")
    with h5py.File(path) as file:
        points = file["special_points"]
        omega, hertz, critical = (points[name][()] for name in ("omega", "frequency", "critical_frequency"))
        check(points["frequency"].attrs["units"] in (b"Hz", "Hz"), "units")
        check(all(close(f, w / (2 * math.pi)) for f, w in zip(hertz, omega)), "Hz is not omega / 2 pi")
        for p in hopf:
            branch = file["branches"][p["branch"]]
            at = min(range(len(branch["omega"])), key=lambda i: abs(branch["omega"][i] - p["omega"]) + abs(branch["u1"][i] - p["u1"]))
            eigenvalues = [complex(branch[f"eig{k}_re"][at], branch[f"eig{k}_im"][at]) for k in range(1, 5)]
            nearest = min(abs(abs(e.imag) - p["critical_frequency"]) + abs(e.real) for e in eigenvalues)
            check(nearest < 0.2 * p["critical_frequency"], f"{p['critical_frequency']} beside {eigenvalues}")
            check(any(close(c, p["critical_frequency"]) for c in critical), "file and JSON differ")
            check(close(p["frequency"], p["omega"] / (2 * math.pi)), "frequency is not in Hz")
    lorenz = open(os.path.join(HERE, "..", "studies", "lorenz.toml")).read()
    told, _ = run(folder, lorenz)
    hopf = [p for p in told["special_points"] if p["type"] == "HB"]
    check(hopf and all(p["frequency"] == p["critical_frequency"] > 0 for p in hopf), "the old name of a Hopf frequency")


def extremes_with_their_sign(folder):
    """q'' + .1 q' + 2 q + a q^2 = F0 + F cos wt: closed form for a = 0; both kinds agree for a = .3."""
    def model(kind, a):
        return f"""study = "{kind}"
[modal_model]
frequency = [1.4142135623730951]
damping = [0.1]
term = [{{equation = 1, coefficient = {a}, powers = [2]}}]
force = [{{equation = 1, amplitude = -0.7, harmonic = 0}}, {{equation = 1, amplitude = 0.3, harmonic = 1}}]
"""
    periodic = '[continuation]\nparameter = "omega"\nrange = [0.5, 1.0]\nuser_values = [0.8]\n[seeds]\ngrid = 3\n'
    point = next(p for p in run(folder, model("periodic", 0.0) + periodic)[0]["special_points"] if p["type"] == "UZ")
    amplitude = 0.3 / abs(2 - 0.8**2 + 0.08j)
    check(close(point["q1_crest"], -0.35 + amplitude, 1e-9), f"{point['q1_crest']} is not {-0.35 + amplitude}")
    check(close(point["q1_trough"], -0.35 - amplitude, 1e-9), f"{point['q1_trough']} is not {-0.35 - amplitude}")
    check(close(point["q1_max"], 0.35 + amplitude, 1e-9), "q1_max is the largest |q1|")
    point = next(p for p in run(folder, model("periodic", 0.3) + periodic)[0]["special_points"] if p["type"] == "UZ")
    rest = run(folder, model("integrate", 0.3) + "[integrate]\nomega = [0.8]\nstarts = [0.0]\nsamples = 4096\n")[0]["attractors"][0]
    for name in ("q1_crest", "q1_trough"):
        check(close(point[name], rest[name], 2e-6), f"{name}: {point[name]} and {rest[name]}")  # 4096 samples: 1e-6 below the top


CATENARY = """study = "catenary-modes"
[cable]
span = 800.0
height_difference = 100.0
length = 1000.0
mass_per_length = 200.0
gravity = 9.81
[modes]
points = 0
"""


def a_hanging_cable_is_told_everywhere(folder):
    """The same numbers on screen, in JSON, in the file and in CSV; end slopes and vertical tensions from the tensions."""
    told, path = run(folder, CATENARY, "reduced.out_of_plane=1", "reduced.in_plane=2")
    cable = told["cable"]
    check(close(cable["a"], 342.241378312559, 1e-12) and close(cable["horizontal_tension"], 671477.584249241, 1e-12), "closed form")
    check(close(cable["lower_vertical_tension"], -861928.697359, 1e-11), "vertical tension")
    check(close(cable["upper_vertical_tension"], 1100071.302641, 1e-11), "vertical tension")
    check(close(cable["upper_slope"], cable["upper_vertical_tension"] / cable["horizontal_tension"]), "slope")
    check(close(cable["lower_slope_deg"], math.degrees(math.atan(cable["lower_slope"]))), "slope in degrees")
    with h5py.File(path) as file:
        check(all(file["cable"][name][()] == value for name, value in cable.items()), "file and JSON differ")
        check(len(told["reduced"]["terms"]) == len(file["reduced/equation"]), "terms of the reduced model")
    check(whirl(folder, "export", "r.h5").returncode == 0, "export")
    with open(os.path.join(folder, "r-csv", "cable.csv")) as file:
        rows = [line for line in csv.reader(file)][1:]
        check({k: float(v) for k, v in zip(*rows)} == cable, "CSV and JSON differ")
    check(os.path.exists(os.path.join(folder, "r-csv", "reduced-modal_model.txt")), "the model as text")
    printed = whirl(folder, "run", "my.toml", "-o", "r.h5").stdout
    for name in ("a", "horizontal_tension", "sag", "length", "lower_tension", "upper_tension", "lower_slope", "upper_slope"):
        line = next((line for line in printed.splitlines() if line.startswith(name + " ")), "")
        check(line and close(float(line.split()[1]), cable[name], 1e-11), f"{name} on screen: {line}")


FORCED = """study = "catenary-forced"
[cable]
span = 100.0
height_difference = 0.0
length = 117.6
mass_per_length = 10.0
[drag]
tangential = 0.1
normal = 0.5
lateral = 0.5
[end_motion]
out_of_plane = [0.1]
[response]
range = [0.5, 4.0]
points = 40
at = [1.0, 2.0]
places = [0.0, 58.8, 117.6]
"""


def motion_out_of_plane_alone_is_told(folder):
    told, path = run(folder, FORCED)
    check(told["largest"]["W"] > 0.1 and told["largest"] == dict(told["largest_out_of_plane"], tension=0, W=told["largest"]["W"]), str(told["largest"]))
    natural = told["natural_out_of_plane"]
    check(min(abs(told["largest"]["omega"] / w - 1) for w in natural) < 1e-2, "the largest is not at a resonance")
    with h5py.File(path) as file:
        check(max(file["resonance/W"]) <= told["largest"]["W"] * (1 + 1e-12), "a larger one in the table")
        ends = [file[f"places/place{j}"]["W"][()] for j in (1, 3)]
        check(max(abs(ends[0])) < 1e-12 and max(abs(ends[1] - 0.1)) < 1e-12, "the ends do not move as told")
    check([row["omega"] for row in told["at"]] == [1.0, 2.0] and close(told["at"][0]["places"][2]["W"], 0.1, 1e-12), "at and places")
    for place in ("-1.0", "118.0"):
        check(whirl(folder, "run", "my.toml", "--set", f"response.places=[{place}]", "-o", "x.h5").returncode == 2, "a place off the cable")


def frequencies_beyond_the_200th(folder):
    """A taut cable: all natural frequencies of the range are listed, evenly spaced as a string's."""
    text = FORCED.replace("length = 117.6", "sag = 0.1").replace("[0.0, 58.8, 117.6]", "[]")
    told, _ = run(folder, text, "response.range=[0.0,2700.0]", "response.points=3", "response.refine=false", "response.at=[]")
    natural = told["natural_out_of_plane"]
    check(len(natural) > 230, f"{len(natural)} frequencies")
    spacing = [b - a for a, b in zip(natural, natural[1:])]
    check(max(spacing) / min(spacing) < 1.001, "a frequency is missing")
    check(not any("not listed" in w for w in told["warnings"]), str(told["warnings"]))


def stiffness_at_frequencies(folder):
    text = whirl(folder, "init", "guy-stiffness").stdout
    told, path = run(folder, text, "stiffness.range=[0.5,2.0]", "stiffness.points=4", "stiffness.at=[1.0,0.5,1.7]", "level.guys=3")
    check([row["omega"] for row in told["stiffness"]] == [1.0, 0.5, 1.7], "frequencies in the order asked for")
    with h5py.File(path) as file:
        check(close(told["stiffness"][0]["xx_re"], file["stiffness/horizontal/full_re"][1], 1e-12), "horizontal")
        check(close(told["stiffness"][1]["yy_im"], file["stiffness/matrix/yy_im"][0], 1e-12), "vertical")
        check(close(told["stiffness"][0]["XX_re"], file["stiffness/level/XX_re"][1], 1e-12), "level")
        check(close(told["stiffness"][2]["zz_re"], file["stiffness/at/zz_re"][2], 1e-15), "table")
    check(whirl(folder, "run", "my.toml", "--set", "stiffness.range=[0.5,2.0]", "--set", "stiffness.at=[2.1]", "-o", "x.h5").returncode == 2, "beyond")


def groups_of_guys(folder):
    told, path = run(folder, whirl(folder, "init", "guy-statics").stdout, "group.guys=3", "group.directions_deg=[0.0,30.0]")
    check([g["direction_deg"] for g in told["groups"]] == [0, 30], "directions")
    with h5py.File(path) as file:
        for g in told["groups"]:
            group = file[f"groups/direction{g['direction_deg']:g}"]
            check(g["tangent"] == group.attrs["tangent"] and g["reaction"] == list(group["reaction"]), "file and JSON differ")
            check(g["largest_tension"] == max(group["largest_tension"]), "largest tension")
    for name in ("upper", "lower"):
        guy = told["guy"]
        check(close(math.hypot(guy["horizontal_tension"], guy[f"{name}_vertical_tension"]), guy[f"{name}_tension"], 1e-9), "vertical tension")
    whirl(folder, "export", "r.h5")
    with open(os.path.join(folder, "r-csv", "attributes.csv")) as file:
        rows = list(csv.reader(file))
    check(["/groups/direction30", "tangent", f"{told['groups'][1]['tangent']:.17g}"] in rows, "tangent in CSV")


def what_does_not_settle_is_told(folder):
    """Averaged stay, integrated for a few periods only: status 1, a reason on standard error, in JSON and in the file."""
    text = open(os.path.join(HERE, "..", "studies", "oresund-superharmonic.toml")).read()
    brief = ["continuation.range=[1.6,1.7]", "verification.omega=[1.65]", "verification.max_periods=20", "verification.sweep_points=0"]
    told, path = run(folder, text, *brief, status=1)
    check(told["outcome"] == "partial" and any("not settled" in w or "still" in w for w in told["warnings"]), str(told["warnings"]))
    check(any(row["motion"] == "unsettled" and row["why"] for row in told["verification"]), "rows")
    with h5py.File(path) as file:
        check(file["study"].attrs["outcome"] in (b"partial", "partial"), "outcome")


# what makes a run of each kind end before it is whole
PARTIAL = {
    "superharmonic": ["continuation.range=[1.55,1.7]", "verification.enabled=false", "continuation.max_points=3"],
    "continuation": ["continuation.max_points=3"],
    "cycles": ["cycles.period_doublings=0", "continuation.max_points=3"],
    "periodic": ["continuation.range=[1.5,1.6]", "seeds.grid=3", "continuation.max_points=3"],
    "slow-flow": ["continuation.range=[1.6,1.65]", "verification.enabled=false", "seeds.max_periods=0", "continuation.max_points=3"],
    "integrate": ["integrate.omega=[1.65]", "integrate.starts=[3.0,0.0]", "sweep.range=[]", "integration.max_periods=20"],
    "basins": ["basins.resolution=[3,3]", "integration.max_periods=20"],
}


def averaged_extremes(folder):
    """q_crest, q_trough and q_max of averaged states are those of the sum of their harmonics."""
    samples = [2.0 * math.pi * i / 2000 for i in range(2000)]
    told, path = run(folder, whirl(folder, "init", "superharmonic").stdout, *BRIEF["superharmonic"])
    with h5py.File(path, "r") as file:
        branches = [{k: v[()] for k, v in group.items()} for group in file["branches"].values()]
    for table in branches:
        for i in range(0, len(table["residual"]), 1 + len(table["residual"]) // 4):
            for q, harmonics in (("q1", [2]), ("q2", [1, 2])):
                waves = [(h, table[f"{q}_h{h}"][i], table[f"{q}_h{h}_phase"][i]) for h in harmonics]
                motion = [sum(a * math.cos(h * t + phase) for h, a, phase in waves) for t in samples]
                size = max(map(abs, motion))
                for column, value in (("crest", max(motion)), ("trough", min(motion)), ("max", size)):
                    got = table[f"{q}_{column}"][i]
                    check(0.0 <= abs(got) - abs(value) + 1e-12 <= 1e-4 * size + 2e-12, f"{q}_{column} {got}, sampled {value}")
    check(all(f"{q}_{c}" in p for p in told["special_points"] for q in ("q1", "q2") for c in ("crest", "trough", "max")), "no extremes in the JSON")


def a_partial_run_tells_why(folder):
    for kind, overrides in PARTIAL.items():
        with open(os.path.join(folder, "my.toml"), "w") as file:
            file.write(whirl(folder, "init", kind).stdout)
        done = whirl(folder, "run", "my.toml", "-q", "-o", "r.h5", *[word for each in overrides for word in ("--set", each)])
        check(done.returncode == 1, f"{kind}: status {done.returncode}: {done.stderr}")
        lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
        check(len(lines) == 1 and len(lines[0]) > len("error: the run is incomplete: "), f"{kind}: {done.stderr}")
        with h5py.File(os.path.join(folder, "r.h5"), "r") as file:
            study = file["study"].attrs
            check(study["outcome"] == "partial", f"{kind}: {study['outcome']}")
            check(any(r.split(": ", 1)[-1] in lines[0] for r in study["stop_reasons"]), f"{kind}: {lines[0]}; {study['stop_reasons']}")


def command_line(folder):
    lines = {(): "a command is needed", ("rn", "x.toml"): "did you mean `whirl run`", ("my.toml",): "whirl run my.toml", ("lst",): "`whirl list`",
             ("qqqqq",): "one of run", ("help", "exprt"): "'export'", ("run",): "FILE", ("--vers",): "see whirl --help"}
    for words, expected in lines.items():
        done = whirl(folder, *words)
        check(done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, f"{words}: {done.returncode} {done.stderr}")
        check(expected in done.stderr, f"{words}: {done.stderr}")
    for words, expected in {("help",): "export", ("help", "run"): "--json", ("version",): "HDF5", ("-V",): "HDF5", ("--version",): "HDF5",
                            ("--help",): "export"}.items():
        done = whirl(folder, *words)
        check(done.returncode == 0 and done.stderr == "" and expected in done.stdout, f"{words}: {done.returncode} {done.stderr}")


def foreign_files_stay(folder):
    with open(os.path.join(folder, "my.toml"), "w") as file:
        file.write(whirl(folder, "init", "modes").stdout)
    for name in ("notes.txt", "data.csv", "r.h5", "picture.hdf5", "plain"):
        with open(os.path.join(folder, name), "w") as file:
            file.write("mine\n")
    with h5py.File(os.path.join(folder, "other.h5"), "w") as file:
        file["x"] = [1.0]
    for name in ("notes.txt", "data.csv", "r.h5", "picture.hdf5", "plain", "other.h5", "new.csv", "new.txt", "new.toml", "new.json"):
        path = os.path.join(folder, name)
        before = open(path, "rb").read() if os.path.exists(path) else None
        done = whirl(folder, "run", "my.toml", "-o", name)
        check(done.returncode == 2 and done.stderr.count("\n") == 1 and name in done.stderr, f"{name}: {done.returncode} {done.stderr}")
        check((open(path, "rb").read() if os.path.exists(path) else None) == before, f"{name} was touched")
    for name in ("new.h5", "new.hdf5", "new", "new.h5"):  # the last over a result
        check(whirl(folder, "run", "my.toml", "-q", "-o", name).returncode == 0, name)
    open(os.path.join(folder, "empty.h5"), "w").close()
    check(whirl(folder, "run", "my.toml", "-q", "-o", "empty.h5").returncode == 0, "an empty file counts as new")


TESTS = [every_kind_prints_strict_json, tables_go_to_standard_output, names_of_any_letters, frequency_means_one_thing, extremes_with_their_sign, averaged_extremes,
         a_hanging_cable_is_told_everywhere, motion_out_of_plane_alone_is_told, frequencies_beyond_the_200th, stiffness_at_frequencies, groups_of_guys,
         what_does_not_settle_is_told, a_partial_run_tells_why, command_line, foreign_files_stay]

if __name__ == "__main__":
    failed = 0
    for test in TESTS:
        if len(sys.argv) > 1 and test.__name__ not in sys.argv[1:]:
            continue
        with tempfile.TemporaryDirectory() as scratch:
            try:
                test(scratch)
            except Exception as wrong:  # of any kind: the others are still of interest
                failed += 1
                print(f"FAILED {test.__name__}: {wrong!r}")
    sys.exit(1 if failed else 0)
