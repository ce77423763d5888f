/* Trusts the force less, the older it is, and adds a damper while the hand presses. docs/howto/controller.md explains each part.
   cc -shared -fPIC -O2 mine.c -o mine.so */
#include <math.h>
#include <stdlib.h>
#include <thimble/controller.h>

enum { TRUST, DAMPING, KEYS };
static const thimble_controller_key keys[KEYS] = {
    {"trust_s", 0.002, 1e-4, 10, "Age at which the force counts half."},
    {"damping_Ns_per_m", 3, 0, 100, "While the hand presses against a force."},
};

struct mine {
    double trust_s, damping_Ns_per_m, velocity_hand_m_per_s;
};

static void* create(const thimble_controller_settings* settings) {
    struct mine* mine = malloc(sizeof *mine);
    if (mine == NULL) return NULL;
    mine->trust_s = settings->values[TRUST];
    mine->damping_Ns_per_m = settings->values[DAMPING];
    mine->velocity_hand_m_per_s = 0;
    return mine;
}

static void start(void* self, double network_delay_s) {
    struct mine* mine = self;
    mine->velocity_hand_m_per_s = 0;
    (void)network_delay_s;
}

static void sample(void* self, const thimble_handle* handle, thimble_packet* out) {
    struct mine* mine = self;
    mine->velocity_hand_m_per_s = handle->velocity_hand_m_per_s;
    (void)out;
}

static double force(void* self, const thimble_feedback* newest) {
    const struct mine* mine = self;
    const double age_s = newest->age_s > 0 ? newest->age_s : 0;
    const double trusted_N = newest->force_total_hand_N * mine->trust_s / (mine->trust_s + age_s);
    const double damper_N = trusted_N > 0 ? mine->damping_Ns_per_m * mine->velocity_hand_m_per_s : 0;
    return isfinite(trusted_N + damper_N) ? trusted_N + damper_N : 0;
}

const thimble_controller* thimble_controller_table(void) {
    static const thimble_controller table = {
        .abi = THIMBLE_CONTROLLER_ABI,
        .name = "mine",
        .keys = keys,
        .key_count = KEYS,
        .create = create,
        .destroy = free,
        .start = start,
        .sample = sample,
        .force = force,
    };
    return &table;
}
