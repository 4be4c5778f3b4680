"""Scenes and runs: the same bits as the command, dicts, Ctrl-C."""
from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import dartcast
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENES = sorted((ROOT / "scenes").glob("*.toml"))
BAR = {
    "seed": np.int64(3),
    "environment": {"generator": "bar"},
    "particles": [{"count": 50, "velocity": np.array([1.0, 2.0, 3.0])}],
    "motion": {"dt": 0.1, "steps": 20},
    "contact": {"response": "reflect", "restitution": 0.9, "patch": None},
}


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_a_run_has_the_state_hash_of_the_command(scene: pathlib.Path, tmp_path: pathlib.Path) -> None:
    command = os.environ.get("DARTCAST_BINARY")
    if command is None:
        pytest.skip("DARTCAST_BINARY does not name the command")
    subprocess.run([command, "run", str(scene), "--steps", "5", "-o", str(tmp_path / "c"), "-q"], check=True)
    expected = json.loads((tmp_path / "c" / "summary.json").read_text(encoding="utf-8"))["state_hash"]
    assert dartcast.run(scene, steps=5).state_hash == expected
    simulation = dartcast.Simulation(dartcast.load_scene(scene))
    for _ in range(5):
        simulation.step()
    assert simulation.state_hash().hex() == expected


def test_a_dict_is_the_scene_of_its_text(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "bar.toml"
    file.write_text('seed = 3\n[environment]\ngenerator = "bar"\n[[particles]]\ncount = 50\nvelocity = [1.0, 2.0, 3.0]\n'
                    '[motion]\ndt = 0.1\nsteps = 20\n[contact]\nresponse = "reflect"\nrestitution = 0.9\n',
                    encoding="utf-8")
    assert dartcast.run(BAR).state_hash == dartcast.run(file).state_hash


def test_texts_and_numbers_of_dicts_survive() -> None:
    text = dartcast.scene_text({"a": 'say "so" \\ é\n', "b": [True, 1, 0.1, 1e300], "c": {"d": None, "e \U0001f600": "x"},
                                "\x7f": dartcast.formats.CellType.TETRAHEDRON})
    assert text == ('"a" = "say \\"so\\" \\\\ é\\n"\n"b" = [true, 1, 0.1, 1e+300]\n"c" = {"e \U0001f600" = "x"}\n'
                    '"\\u007f" = "tetrahedron"\n')
    with pytest.raises(TypeError, match=r"a\[1\].b: .*object"):
        dartcast.scene_text({"a": [1, {"b": object()}]})
    scene = dartcast.formats.parse_scene(dartcast.scene_text(BAR | {"environment": {"generator": "box",
                                                                           "type": dartcast.formats.CellType.TETRAHEDRON}}), "x")
    assert scene.environment.mesh.type == dartcast.formats.CellType.TETRAHEDRON


def test_errors_name_the_key() -> None:
    with pytest.raises(dartcast.Error, match="sice"):
        dartcast.run({"environment": {"generator": "bar", "sice": 3}})


def test_a_run_writes_its_folder(tmp_path: pathlib.Path) -> None:
    seen: list[int] = []
    summary = dartcast.run(BAR, tmp_path, audit=True, progress=lambda done, all_: seen.append(done))
    assert summary.audit.failed == 0 and summary.steps == 20 and seen == list(range(1, 21))
    assert (tmp_path / "summary.json").exists() and (tmp_path / "particles.pvd").exists()


def test_progress_cancels_and_its_errors_come_out(tmp_path: pathlib.Path) -> None:
    assert dartcast.run(BAR, progress=lambda done, all_: done < 3).cancelled

    def fail(done: int, all_: int) -> bool:
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        dartcast.run(BAR, progress=fail)


def test_ctrl_c_ends_a_run_between_two_steps(tmp_path: pathlib.Path) -> None:
    program = ("import dartcast\n"
               f"scene = {{'environment': {{'generator': 'bar'}}, 'particles': [{{'count': 500}}],"
               f" 'motion': {{'dt': 0.1, 'steps': 10**7}}}}\n"
               f"dartcast.run(scene, {str(tmp_path)!r}, progress=lambda done, all_: print(done, flush=True))\n")
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        assert process.stdout is not None and process.stdout.readline()
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors and process.returncode != 0
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["steps"] > 0


def test_a_run_leaves_its_report(tmp_path: pathlib.Path) -> None:
    summary = dartcast.run(BAR, tmp_path / "a")
    assert summary.report is not None and summary.report.file == dartcast.formats.report_file(tmp_path / "a")
    page = summary.report.file.read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>") and len(page.encode()) == summary.report.bytes
    assert (summary.report.particles, summary.report.frames, summary.report.notes) == (50, 3, [])
    few = dartcast.formats.write_report(tmp_path / "a", dartcast.formats.ReportOptions(particles=7, frames=2))
    assert (few.particles, few.particles_of_run, few.frames, few.frames_recorded) == (7, 50, 2, 3)
    assert len(few.notes) == 2
    with pytest.raises(dartcast.Error, match="report.bin"):
        dartcast.formats.write_report(tmp_path / "none")
    with pytest.raises(dartcast.InvalidArgument, match="at least one particle"):
        dartcast.formats.write_report(tmp_path / "a", dartcast.formats.ReportOptions(particles=0))
    assert dartcast.run(BAR | {"output": {"report": False}}, tmp_path / "b").report is None
    assert not dartcast.formats.report_file(tmp_path / "b").exists()
