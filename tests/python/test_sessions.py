"""Sessions step by step, studies against the program, logs against its export, the environment."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy
import pandas
import pytest

import thimble

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from one_trial import port_block  # noqa: E402

BIN = pathlib.Path(os.environ["THIMBLE_BIN"])


def program(*words):
    return subprocess.run([BIN / "thimble", *map(str, words)], check=True, capture_output=True, text=True)


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """trials.csv of the program, a subject of experiment 3."""
    out = tmp_path_factory.mktemp("study")
    program("study", "--experiment", 3, "--subjects", 1, "--seed", 7, "--no-control", "--out", out)
    return out


def test_a_study_has_the_programs_bytes(told):
    text = thimble._thimble.study_table(thimble.session_file("paper-experiment-3"), {}, 1, 7, None, 2)
    assert text == (told / "trials.csv").read_text()
    assert thimble.read_trials(told).equals(thimble.study(subjects=1, seed=7))


def test_a_study_writes_the_programs_files(told, tmp_path):
    frame = thimble.study(subjects=1, seed=7, out=tmp_path / "out", control=False)
    assert frame.equals(thimble.read_trials(told))
    for name in ("trials.csv", "subjects.csv", "trials_curves.csv", "findings.json", "claims.json"):
        assert (tmp_path / "out" / name).read_bytes() == (told / name).read_bytes(), name
    with pytest.raises(ValueError, match="already exists"):
        thimble.study(subjects=1, seed=7, out=tmp_path / "out")
    (tmp_path / "dataset_description.json").write_text('{"SubjectKind": "human"}')
    with pytest.raises(ValueError, match="a dataset of human participants"):
        thimble.study(subjects=1, seed=7, out=tmp_path)


def test_a_study_names_the_parameters_that_ran(tmp_path):
    program("study", "paper-experiment-3", "--subjects", 1, "--seed", 7, "--order", "williams", "--no-control", "--out", tmp_path / "program")
    thimble.study(subjects=1, seed=7, order="williams", control=False, out=tmp_path / "python")
    key = "all parameters of paper-experiment-3.toml"
    told, python = (json.loads((tmp_path / name / "summary.json").read_text())["provenance"][key] for name in ("program", "python"))
    assert python == told and "session.seed = 7\n" in python


def test_a_trial_alone_is_the_trial_of_the_study(told):
    row = thimble.read_trials(told).iloc[4]
    session = thimble.Session("paper-experiment-3")
    session.start(row.modality, delay_s=0.05, seed=7, subject=1, trial=int(row.trial))
    while session.step(session.now_s + 0.1):
        pass
    mine = pandas.Series(session.trial())
    assert all(str(mine[name]) == str(row[name]) or mine[name] == row[name] or pandas.isna(row[name]) for name in row.index)
    trajectory = session.trajectory()
    assert trajectory["time_s"].shape == trajectory["force_total_N"].shape and trajectory["fixture_present"].dtype == bool
    assert trajectory["position_needle_m"].max() - session.fixture_m == pytest.approx(row.penetration_max_m, abs=1e-9)


def push(session, speed_m_per_s=0.05, depth_m=0.2):
    while session.step(session.now_s + 0.01):
        session.hand(min(depth_m, speed_m_per_s * session.time_s))
        yield session.state()


@pytest.mark.parametrize("modality, shown", [("HF", "force_hand_N"), ("CF", "force_finger_N"), ("VF", "force_bar_N")])
def test_pythons_hand_feels_what_the_modality_shows(modality, shown):
    session = thimble.Session(hand="python")
    session.start(modality, delay_s=0.1, fixture_m=0.1)
    states = [state for state, _ in zip(push(session), range(400))]
    touched = next(state["now_s"] for state in states if state["force_fixture_N"] < 0)
    felt = next(state["now_s"] for state in states if abs(state[shown]) > 0.5)
    assert 0.09 < felt - touched < 0.6
    for other in {"force_hand_N", "force_finger_N", "force_bar_N"} - {shown}:
        assert all(state[other] == 0 for state in states)
    session.stop()
    assert session.outcome == "interrupted" and not session.running


def test_what_a_session_cannot_do_is_said():
    session = thimble.Session()
    for call, words in ((session.step, "start"), (lambda: session.hand(0), "virtual operator"), (lambda: session.start("XF"), "HF, CF"),
                        (lambda: session.start(delay_s=-1), "delay_s"), (lambda: thimble.Session("no-such"), "paper-experiment-1"),
                        (lambda: thimble.Session({"master": {"position_scal": 1}}), "position_scale"),
                        (lambda: thimble.Session(changes={"handle.friction_N": -1}), "friction_N"),
                        (lambda: thimble.study(order="sorted"), "williams"), (lambda: thimble.study(subjects=0), "subjects 0: has to be 1")):
        with pytest.raises(ValueError, match=words):
            call()


def test_a_dictionary_may_hold_arrays_and_a_seed_keeps_its_digits():
    session = thimble.Session({"session": {"delays_s": numpy.array([0, 0.01])}}, hand="python")
    session.start(seed=2**64 - 1)
    session.step(0.1)
    session.stop()
    assert session.trial()["delay_s"] == 0.01 and session.trial()["seed"] == 2**64 - 1


def test_ctrl_c_ends_long_work():
    code = "import thimble, sys\nprint('go', flush=True)\nthimble.study(subjects=100000)"
    with subprocess.Popen([sys.executable, "-B", "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        running.stdout.readline()
        time.sleep(0.3)
        running.send_signal(signal.SIGINT)
        words = running.communicate(timeout=60)[1]
    assert "KeyboardInterrupt" in words


@pytest.fixture
def base_port():
    with port_block() as base:
        yield base


def test_a_log_has_what_the_program_exports(tmp_path, base_port, monkeypatch):
    monkeypatch.setenv("THIMBLE_STOP_DIR", str(tmp_path))
    session = tmp_path / "session.toml"
    session.write_text("[session]\nmodalities = ['CF']\ndelays_s = [0.01]\n[trial]\ncontact_hold_s = 0.1\ntimeout_s = 1\n[log]\nmessages = 'all'\n")
    program("run", session, "--clock", "lock-step", "--base-port", base_port, "--out", tmp_path / "run")
    log = next(path for path in (tmp_path / "run").rglob("*master*.mcap"))
    program("log", "export", log, "--csv", tmp_path / "csv")
    tables = thimble.read_log(log)
    exported = {path.name: pandas.read_csv(path, float_precision="round_trip", keep_default_na=False) for path in (tmp_path / "csv").glob("*.csv")}
    assert len(tables) == len(exported) > 2
    for (topic, kind), columns in tables.items():
        frame = next(table for name, table in exported.items() if name.endswith(f"{topic.replace('/', '.')}.{kind}.csv"))
        for name in columns.keys() & frame.columns:
            assert numpy.array_equal(columns[name], frame[name].to_numpy().astype(columns[name].dtype)), name
    with pytest.raises(OSError) as refused:
        thimble.read_log(session)
    assert refused.value.exit_code == 5


def test_a_policy_completes_a_trial_in_the_environment():
    env = thimble.NeedleEnv("CF", delay_s=0.02, session={"trial": {"contact_hold_s": 0.3}})
    observation, info = env.reset(seed=3)
    total, over = 0.0, False
    while not over:
        assert env.observation_space.contains(observation)
        speed = -1 if info["beeped"] else 0 if observation[2] > 0.3 else 0.5
        observation, reward, terminated, truncated, info = env.step(numpy.array([speed], "float32"))
        total, over = total + reward, terminated or truncated
    assert terminated and total > 5 and info["outcome"] == "completed"
    with pytest.raises(ValueError, match="reset"):
        env.step(env.action_space.sample())


def test_episodes_of_a_seed_are_the_same():
    runs = []
    for _ in range(2):
        env = thimble.NeedleEnv("HF")
        runs.append([env.reset(seed=5)[0], *(env.step([0.9])[0] for _ in range(100))])
    assert numpy.array_equal(runs[0], runs[1]) and numpy.any(runs[0][-1] != runs[0][0])


def test_a_board_has_the_rows_of_the_program(tmp_path):
    words = ["board", "--quick", "--only", "HF,every-sample,0ms,50ms", "--seed", 3, "--out", tmp_path / "program"]
    program(*words)
    frame = thimble.board(only=["HF", "every-sample", "0ms", "50ms"], trials=5, seed=3, out=tmp_path / "python")
    assert (tmp_path / "python/board.csv").read_bytes() == (tmp_path / "program/board.csv").read_bytes()
    pandas.testing.assert_frame_equal(frame, thimble.read_board(tmp_path / "program"))
    assert list(frame.controller) == ["HF", "HF"] and set(frame.status) == {"ok"} and set(frame.trials) == {5}
    with pytest.raises(thimble.UsageError, match="python"):
        thimble.board(only=["HF"], out=tmp_path / "python")
    with pytest.raises(thimble.UsageError, match="no-such"):
        thimble.board(only=["no-such"])


def test_frames_say_what_they_need(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    for call in (thimble.study, thimble.board, lambda: thimble.read_board("nowhere")):
        with pytest.raises(ImportError, match="python3-pandas"):
            call()


def test_gymnasiums_own_checker_agrees():
    checker = pytest.importorskip("gymnasium.utils.env_checker", reason="there is no gymnasium, which Debian 12 does not have")
    checker.check_env(thimble.NeedleEnv("CF"), skip_render_check=True)
