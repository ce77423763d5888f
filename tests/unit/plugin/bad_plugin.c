/* A plug-in with the fault that its key names, for tests of what a fault costs. The order is that of Fault in plugins.hpp. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

#include <thimble/controller.h>

#ifndef BAD_ABI
#define BAD_ABI THIMBLE_CONTROLLER_ABI
#endif

enum fault { NONE, CRASH, NOT_A_NUMBER, HANG, ALLOCATE, CLOCK, RANGE, LEAVE, REFUSE, GLOBAL, ACTIVE, REMEMBER, ABORT, RANDOM, FAR, ECHO, SHARED_SLAVE, OLD_SLAVE, HANG_IN_CREATE, HANG_IN_DESTROY, SLOW_IN_CREATE };

struct bad {
    enum fault fault;
    int samples;
    double speed_m_per_s, position_m;
};

static double shared;

static void* create(const thimble_controller_settings* settings) {
    struct bad* bad = calloc(1, sizeof *bad);
    bad->fault = (enum fault)settings->values[0];
    while (bad->fault == HANG_IN_CREATE) pause();
    if (bad->fault == SLOW_IN_CREATE) usleep(10000);
    if (bad->fault != REFUSE) return bad;
    free(bad);
    return NULL;
}

static void destroy(void* self) {
    const struct bad* bad = self;
    while (bad->fault == HANG_IN_DESTROY) pause();
    free(self);
}

static void start(void* self, double network_delay_s) {
    struct bad* bad = self;
    (void)network_delay_s;
    if (bad->fault != REMEMBER) bad->samples = 0;
}

static void sample(void* self, const thimble_handle* handle, thimble_packet* out) {
    struct bad* bad = self;
    (void)out;
    bad->speed_m_per_s = handle->velocity_hand_m_per_s;
    if (++bad->samples != 20) return;
    if (bad->fault == CRASH) raise(SIGSEGV);
    if (bad->fault == ABORT) abort();
    if (bad->fault == LEAVE) _exit(0);
    if (bad->fault == ALLOCATE) {
        char* volatile name = malloc(7);
        free(name);
    }
    unsigned char drawn = 0;
    if (bad->fault == RANDOM && getrandom(&drawn, 1, 0) < 0) abort();
}

static double force(void* self, const thimble_feedback* newest) {
    struct bad* bad = self;
    const double wanted_N = isfinite(newest->force_total_hand_N) ? newest->force_total_hand_N : 0;
    struct timespec now = {0};
    switch (bad->fault) {
        case HANG:
            while (bad->samples > 20) *(volatile int*)&bad->samples += 0;
            return 0;
        case NOT_A_NUMBER:
            return bad->samples > 20 ? NAN : wanted_N;
        case CLOCK:
            clock_gettime(CLOCK_MONOTONIC, &now);
            return now.tv_sec < 0;
        case RANGE:
            return 1e6;
        case GLOBAL:
            return shared += 0.001;
        case ACTIVE:
            return -2;
        case REMEMBER:
            return bad->samples * 1e-3;
        default:
            return wanted_N;
    }
}

#ifdef BOTH_ENDS
static uint32_t receive_slave(void* self, const thimble_command* command, const thimble_packet* packet) {
    struct bad* bad = self;
    (void)packet;
    bad->position_m = command->position_hand_m;
    ++bad->samples;
    return 1;
}

static double step_slave(void* self, const thimble_surroundings* surroundings) {
    const struct bad* bad = self;
    (void)surroundings;
    switch (bad->fault) {
        case FAR:
            return 1e3;
        case ECHO:
            return bad->position_m;
        case SHARED_SLAVE:
            return shared += 1e-6;
        case OLD_SLAVE:
            return bad->samples * 1e-6;
        default:
            return 0;
    }
}

static void start_slave(void* self) {
    struct bad* bad = self;
    if (bad->fault != OLD_SLAVE) bad->samples = 0;
}

static void answer_slave(void* self, const thimble_feedback* felt, thimble_packet* out) {
    (void)self, (void)felt, (void)out;
}
#endif

const thimble_controller* thimble_controller_table(void) {
    static const thimble_controller_key keys[] = {{"fault_number", NONE, NONE, SLOW_IN_CREATE, "What it does wrong."}};
    static const thimble_controller table = {
        .abi = BAD_ABI,
#ifdef BOTH_ENDS
        .capabilities = THIMBLE_BOTH_ENDS,
        .create_slave = create,
        .destroy_slave = destroy,
        .start_slave = start_slave,
        .receive_slave = receive_slave,
        .step_slave = step_slave,
        .answer_slave = answer_slave,
#else
        .capabilities = THIMBLE_PASSIVE,
#endif
        .name = "bad",
        .keys = keys,
        .key_count = 1,
        .create = create,
        .destroy = destroy,
        .start = start,
        .sample = sample,
        .force = force,
    };
    return &table;
}
