#!/usr/bin/env python3
"""A slave whose tissue is a spring with a damper takes part in lock-step beside Thimble's own programs (docs/clocks.md).
In lock-step the conductor looks for silent peers, so this slave does not."""
import math
import sys

import lock_step

SURFACE_m, STIFFNESS_N_per_m, DAMPING_Ns_per_m, FIXTURE_N_per_m = 0.020, 1.5, 2.0, 3000.0


class Slave(lock_step.Slave):
    def __init__(self, *words):
        super().__init__(*words)
        hold_s = self.session.get('trial', {}).get('contact_hold_s', 5.0)
        if isinstance(hold_s, str):
            sys.exit('slave.py: write [trial] contact_hold_s as a number of seconds, without a unit')
        self.hold_ns = round(hold_s * 1e9)
        self.fixture_m, self.touched_ns, self.beeped = math.inf, None, False

    def started(self, fixture_m):
        self.fixture_m = math.inf if fixture_m is None else fixture_m

    def follow(self, now, sampled_ns, number, needle_m, velocity_m_per_s, smooth_m):
        depth_m, beyond_m = max(0.0, smooth_m - SURFACE_m), max(0.0, needle_m - self.fixture_m)
        push_N = STIFFNESS_N_per_m * depth_m + DAMPING_Ns_per_m * velocity_m_per_s
        tissue_N, fixture_N = -max(0.0, push_N) if depth_m > 0 else 0.0, -FIXTURE_N_per_m * beyond_m
        self.touched_ns = (self.touched_ns or sampled_ns) if beyond_m > 0 else None
        contact_ns = sampled_ns - (self.touched_ns or sampled_ns)
        self.feedback(now, needle_m, SURFACE_m, 0, needle_m - beyond_m, tissue_N, fixture_N, tissue_N + fixture_N, contact_ns / 1e9,
                      sampled_ns, 0, number, 2 * (depth_m > 0), self.fixture_m < math.inf, False)
        if contact_ns >= self.hold_ns and not self.beeped:
            self.beeped = True
            self.beep(now)


if __name__ == '__main__':
    sys.exit(lock_step.run(Slave))
