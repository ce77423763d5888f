/* A plug-in with the fault that its key names, for tests of what a fault costs. The order is that of plugin_test.cpp. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include <thimble/controller.h>

#ifndef BAD_ABI
#define BAD_ABI THIMBLE_CONTROLLER_ABI
#endif

enum fault { NONE, CRASH, NOT_A_NUMBER, HANG, ALLOCATE, CLOCK, RANGE, LEAVE, REFUSE, GLOBAL, ACTIVE, REMEMBER, ABORT };

struct bad {
    enum fault fault;
    int samples;
    double speed_m_per_s;
};

static double shared;

static void* create(const thimble_controller_settings* settings) {
    struct bad* bad = calloc(1, sizeof *bad);
    bad->fault = (enum fault)settings->values[0];
    if (bad->fault != REFUSE) return bad;
    free(bad);
    return NULL;
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
    (void)self, (void)command, (void)packet;
    return 1;
}

static double step_slave(void* self, const thimble_surroundings* surroundings) {
    (void)self, (void)surroundings;
    return 0;
}

static void start_slave(void* self) { (void)self; }

static void answer_slave(void* self, const thimble_feedback* felt, thimble_packet* out) {
    (void)self, (void)felt, (void)out;
}
#endif

const thimble_controller* thimble_controller_table(void) {
    static const thimble_controller_key keys[] = {{"fault_number", NONE, NONE, ABORT, "What it does wrong."}};
    static const thimble_controller table = {
        .abi = BAD_ABI,
#ifdef BOTH_ENDS
        .capabilities = THIMBLE_BOTH_ENDS,
        .create_slave = create,
        .destroy_slave = free,
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
        .destroy = free,
        .start = start,
        .sample = sample,
        .force = force,
    };
    return &table;
}
