#!/usr/bin/env python3
"""The controller of mine.c in Python: trusts the force less, the older it is, and adds a damper while the hand presses."""
from thimble_controller import Controller, serve


class Mine(Controller):
    NAME = 'mine in Python'
    KEYS = {
        'trust_s': (0.002, 1e-4, 10, 'Age at which the force counts half.'),
        'damping_Ns_per_m': (3, 0, 100, 'While the hand presses against a force.'),
    }

    def start(self, network_delay_s):
        self.velocity_hand_m_per_s = 0.0

    def sample(self, handle):
        self.velocity_hand_m_per_s = handle.velocity_hand_m_per_s

    def force(self, newest):
        trusted_N = newest.force_total_hand_N * self.trust_s / (self.trust_s + max(newest.age_s, 0))
        return trusted_N + (self.damping_Ns_per_m * self.velocity_hand_m_per_s if trusted_N > 0 else 0)


serve(Mine)
