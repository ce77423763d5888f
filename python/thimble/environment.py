"""The needle task as an environment with the interface of Gymnasium. Its class is a gymnasium.Env where gymnasium can be imported."""
import math

from .errors import UsageError
from .sessions import Session

try:
    import gymnasium

    _Base, _Box = gymnasium.Env, gymnasium.spaces.Box
except ImportError:

    class _Base:
        metadata, render_mode, spec = {}, None, None

        @property
        def unwrapped(self):
            return self

        def close(self):
            pass

    class _Box:
        """The part of gymnasium.spaces.Box that a policy needs."""

        def __init__(self, low, high, dtype):
            import numpy

            self.low, self.high, self.dtype = numpy.asarray(low, dtype), numpy.asarray(high, dtype), numpy.dtype(dtype)
            self.shape, self._random = self.low.shape, numpy.random.default_rng()

        def seed(self, seed=None):
            import numpy

            self._random = numpy.random.default_rng(seed)
            return [seed]

        def sample(self):
            return self._random.uniform(self.low, self.high).astype(self.dtype)

        def __contains__(self, value):
            return self.contains(value)

        def contains(self, value):
            return getattr(value, "shape", None) == self.shape and bool((value >= self.low).all() and (value <= self.high).all())


OBSERVED = ("handle_m", "force_hand_N", "force_finger_N", "force_bar_N", "beeped")
_LIMITS = (1.0, 20.0, 20.0, 20.0, 1.0)  # of each observed value, either sign


class NeedleEnv(_Base):
    """The paper's trial for a policy: push the needle through the tissue to a stiff fixture that it cannot see, keep contact until the
    beep, withdraw.

    action, shape (1,), float32 in [-1, 1]: the hand's velocity, times speed_m_per_s. It moves the place to which a spring draws the handle.
    observation, shape (5,), float32: handle_m, force_hand_N, force_finger_N, force_bar_N, beeped (0 or 1): what a subject has of the
    modality, after the network's delay and the devices' lag. modality "HF", "CF", "CCF" or "VF".
    reward of a step: step_s while the needle touches the fixture before the beep, minus the metres by which it is beyond it, times 100
    per second; after the beep minus step_s; 10 for a trial that is completed.
    terminated: the trial is completed. truncated: its time is up ([trial] timeout_s), or it has ended in another way.
    info: the dictionary of Session.state(), with undelayed truth that no policy should see.

    session and changes are those of Session. reset(seed=n) chooses the study's seed; each further reset() is the next trial of it. An
    episode's numbers depend on the seed, the trial's number and the actions alone.
    """

    metadata = {"render_modes": []}

    def __init__(self, modality="CF", delay_s=0.05, *, session=None, changes=None, step_s=0.02, speed_m_per_s=0.1, render_mode=None):
        import numpy

        if render_mode is not None:
            raise UsageError(f"render_mode {render_mode!r}: there is none but None; thimble play --replay draws a session's trials")
        if not 0.001 <= step_s <= 10 or not 0 < speed_m_per_s <= 10:
            raise UsageError(f"step_s is {step_s} and must be in [0.001, 10], speed_m_per_s is {speed_m_per_s} and must be in (0, 10]")
        self._numpy, self.render_mode = numpy, None
        self.modality, self.delay_s, self.step_s, self.speed_m_per_s = modality, delay_s, step_s, speed_m_per_s
        self.session = Session(session, hand="python", changes=changes)
        self.action_space = _Box(numpy.full(1, -1, "float32"), numpy.full(1, 1, "float32"), dtype=numpy.float32)
        limits = numpy.array(_LIMITS, "float32")
        self.observation_space = _Box(-limits, limits, dtype=numpy.float32)
        self._seed, self._trial, self._wanted_m, self._over = None, 0, 0.0, True

    def reset(self, *, seed=None, options=None):
        """Begins the next trial, or the first one of a seed; returns (observation, info)."""
        if hasattr(super(), "reset"):
            super().reset(seed=seed)
        self._trial = self._trial + 1 if seed is None else 1
        self._seed = self._seed if seed is None else int(seed)
        self.session.start(self.modality, delay_s=self.delay_s, seed=self._seed, trial=self._trial)
        self._wanted_m, self._over = 0.0, False
        while self.session.step() and self.session.time_s == 0:
            pass  # until all programs have begun
        state = self.session.state()
        return self._observe(state), state

    def step(self, action):
        """Moves the hand for step_s; returns (observation, reward, terminated, truncated, info)."""
        if self._over:
            raise UsageError("the episode is over, or none has begun: call reset() first")
        speed = float(self._numpy.asarray(action, "float64").reshape(-1)[0])
        if not math.isfinite(speed):
            raise UsageError(f"action is {speed}, and must be a number in [-1, 1]")
        self._wanted_m = min(1.0, max(-1.0, self._wanted_m + min(1.0, max(-1.0, speed)) * self.speed_m_per_s * self.step_s))
        self.session.hand(self._wanted_m)
        self._over = not self.session.step(self.session.now_s + self.step_s)
        state = self.session.state()
        terminated = state["outcome"] == "completed"
        return self._observe(state), self._reward(state), terminated, self._over and not terminated, state

    def _observe(self, state):
        values = self._numpy.array([state[name] for name in OBSERVED], "float32")
        return self._numpy.clip(values, self.observation_space.low, self.observation_space.high)

    def _reward(self, state):
        beyond_m = max(0.0, state["needle_m"] - state["fixture_m"])
        reward = -100 * beyond_m * self.step_s
        if state["beeped"]:
            reward -= self.step_s
        elif state["contact_s"] > 0:
            reward += self.step_s
        return float(reward + (10 if state["outcome"] == "completed" else 0))
