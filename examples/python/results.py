"""The results of a run, read back from its folder: frames, tables, the usual figures."""
import pathlib
import sys
import tempfile

import matplotlib.pyplot as plt

import dartcast as dc

scene = {
    "environment": {"generator": "vessel"},
    "particles": [{"inlet": "inlet", "rate": 5000.0, "velocity": [0.0, 0.0, 0.1]}],
    "motion": {"dt": 2e-3, "steps": 500, "field": "velocity", "drag": 500.0, "gravity": [0.0, -0.5, 0.0]},
    "contact": {"response": "absorb", "patch": {"inlet": {"response": "reflect"}, "outlet_left": {"response": "escape"},
                                                "outlet_right": {"response": "escape"}}},
    "statistics": {"residence": True, "pathlines": {"every": 20}},
    "output": {"contacts": True, "every": 10},
}
folder = pathlib.Path(tempfile.mkdtemp()) / "vessel"
summary = dc.run(scene, folder, progress=True)

run = dc.read_run(folder)
run  # a notebook shows a table and a picture

print(f"{len(run)} frames, the last one: {run[-1]}")
print(f"{len(run.contacts)} contacts, for pandas.DataFrame(run.contacts); the first: {run.contacts[0]}")
print({row["patch"]: int(row["deposited"]) for row in run.table("deposition") if row["deposited"]})

figure, axes = plt.subplots(2, 3, figsize=(14, 7), layout="constrained")
for what, place in zip(["paths", "deposition", "residence", "penetration", "energy", "particles"], axes.flat):
    run.plot(what, place)
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "results.png", dpi=70)
