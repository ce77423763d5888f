"""Links, scenes, settings and errors."""
import math

import numpy
import pytest

import thimble

TIMES = numpy.arange(2000) * 1e-3


def test_a_plain_link_delays_each_packet():
    assert numpy.allclose(thimble.LinkModel(delay_s=0.05).fates(TIMES), TIMES + 0.05, atol=1e-9)


def test_fates_depend_on_the_seed_and_the_number_alone():
    keys = {"delay_s": 0.05, "jitter": "normal", "jitter_spread_s": 0.005, "loss": 0.1}
    first, again, other = (thimble.LinkModel(seed=seed, **keys).fates(TIMES) for seed in (1, 1, 2))
    assert numpy.array_equal(first, again, equal_nan=True) and not numpy.array_equal(first, other, equal_nan=True)
    assert 100 < numpy.isnan(first).sum() < 300
    later = thimble.LinkModel(seed=1, **keys).fates(TIMES + 5)
    assert numpy.array_equal(numpy.isnan(later), numpy.isnan(first))


def test_packets_pass_one_by_one():
    link = thimble.LinkModel(delay_s=0.01)
    assert link.push(0.0, b"first") == 0 and link.push(0.001, b"second") == 1
    assert link.next_due_s == pytest.approx(0.01) and link.pop(0.009) is None
    assert link.pop(0.01) == (0, b"first") and link.in_flight == 1
    assert link.pop(1.0) == (1, b"second") and link.next_due_s == math.inf
    assert link.counters["delivered"] == 2
    with pytest.raises(ValueError, match="none is before the last one"):
        link.push(0.5, b"")


def test_a_profile_has_two_ways_and_a_table_may_be_a_dictionary():
    up, down = (thimble.LinkModel(profile="leo", way=way).fates(TIMES) for way in ("up", "down"))
    assert not numpy.array_equal(up, down, equal_nan=True)
    bursts = thimble.LinkModel(loss={"model": "gilbert", "share": numpy.array(0.2), "mean_burst": 5}, delay_s=numpy.float32(0.5))
    assert numpy.isnan(bursts.fates(TIMES)).any()


@pytest.mark.parametrize("profile", ["lan", "leo", "lte", "wifi", "delay 5ms rate 1mbit limit 20 slot 2ms 8ms"])
def test_every_kind_of_link_comes_to_an_end(profile):
    link = thimble.LinkModel(profile=profile)
    arrivals = link.fates(TIMES, 1000)
    assert link.in_flight == 0 and numpy.isfinite(arrivals).any() and (numpy.nan_to_num(arrivals, nan=9) >= TIMES).all()
    assert numpy.isfinite(arrivals).sum() == link.counters["delivered"] - link.counters["duplicated"]


@pytest.mark.parametrize("keys, words", [({"delay": 1}, "did you mean 'delay_s'"), ({"loss": 2}, "loss"), ({"loss": None}, "is no number, text"),
                                         ({"delay_s": 2**70}, f"{2**70}: is no whole number of 64 bits"),
                                         ({"way": "left"}, "must be"), ({"profile": 'no "such'}, "no")])
def test_wrong_settings_are_refused_by_name(keys, words):
    with pytest.raises(thimble.UsageError, match=words) as refused:
        thimble.LinkModel(**keys)
    assert refused.value.exit_code == 2 and isinstance(refused.value, ValueError)


def test_more_threads_than_the_command_line_takes_are_refused():
    with pytest.raises(thimble.UsageError, match="jobs 100000: has to be 0"):
        thimble.study(jobs=100000)


def test_a_needle_meets_skin_and_fixture():
    scene = thimble.Scene("paper.toml")
    time_s = numpy.arange(0, 13, 1e-3)
    forces = scene.follow(time_s, 0.01 * time_s)
    assert forces["force_tissue_N"].shape == time_s.shape and forces["force_tissue_N"][1000] == 0
    assert forces["force_tissue_N"].min() < -0.05 and forces["force_fixture_N"][-1] < -1
    assert scene.events[0][0] == pytest.approx(2.0, abs=1e-6) and scene.events[0][2] == "contact"
    scene.place_fixture(0.05, False)
    scene.reset()
    assert all(scene.step(1e-3, 0.01 * t) == scene.force_tissue_N for t in time_s[1:])


def test_a_scene_is_the_same_step_by_step():
    scene, time_s = thimble.Scene(), numpy.arange(4096) * 2.0**-10
    whole = scene.follow(time_s, 0.02 * time_s)["force_tissue_N"]
    scene.reset()
    assert [scene.step(2.0**-10, 0.02 * t) for t in time_s[1:]] == list(whole[1:])


def test_wrong_scenes_are_refused():
    with pytest.raises(ValueError, match="duration_s"):
        thimble.Scene().step(-1, 0)
    with pytest.raises(ValueError, match="pairs"):
        thimble.Scene().follow([0, 1], [0])
    with pytest.raises(ValueError, match="rk4"):
        thimble.Scene(solver="euler")
    with pytest.raises(thimble.Error, match="no-such.toml"):
        thimble.Scene("no-such.toml")


def test_every_exit_code_has_an_exception():
    for code, kind in ((1, RuntimeError), (2, ValueError), (3, OSError), (4, RuntimeError), (5, OSError)):
        made = thimble.errors.of_code(code, "words")
        assert isinstance(made, kind) and made.exit_code == code and str(made) == "words"


def test_what_is_public_has_a_description():
    for name in thimble.__all__:
        assert getattr(thimble, name).__doc__, name
    for kind in (thimble.LinkModel, thimble.Scene, thimble.Session.__mro__[1]):
        assert all(member.__doc__ for name, member in vars(kind).items() if not name.startswith("_")), kind
