/* A controller against delay, as a plug-in: one shared library that exports thimble_controller_table(). C11 and C++.
   docs/howto/controller.md walks through an example. Thimble's own compensators use this interface too.

   Units and frame. All quantities are in SI units and in the hand's frame: metres of the hand, newtons at the handle. z points
   into the tissue. A force is positive if it pushes the hand out (towards -z).

   Order of the calls. For each trial in the handle modality (HF): start, then for each sample of the handle
       sample            where the hand is now
       force             the force to hold until the next sample
   and, for each force that the network brings, at any time between two samples
       receive_packet    if the message carries a packet (THIMBLE_BOTH_ENDS)
       receive
   A force that arrives in the instant of a sample counts for that sample: force() is then called again.

   Rules. One end is called by one thread at a time. Several ends may exist at once, so keep nothing in global variables.
   After create(): no allocation, no clock, no file, no random number that is not computed from the settings. No exception may
   leave a function. `thimble board --check FILE` tests these rules. All structs passed in are valid during the call only. */
#ifndef THIMBLE_CONTROLLER_H
#define THIMBLE_CONTROLLER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Changes whenever a struct below changes. Thimble refuses a plug-in with another number. */
#define THIMBLE_CONTROLLER_ABI 1u

enum {
    /* It has an end at the slave as well, and messages carry its packets both ways. A session with [codec] refuses such a plug-in:
       each packet carries its own sample's values. */
    THIMBLE_BOTH_ENDS = 1u,
    /* force() is called when a force arrives, not at samples. Right for a function of that force alone. With [codec] force =
       "deadband-linear" it is called at samples as well. */
    THIMBLE_AT_ONCE = 2u,
    /* It promises passivity: sum of force x travel of the hand + device_damping_Ns_per_m x travel^2 / sample_period_s >= 0. */
    THIMBLE_PASSIVE = 4u
};

/* A number that the user may set in [control.plugin_settings]. */
typedef struct thimble_controller_key {
    const char* name; /* ends in its unit, as gain_N_per_m */
    double fallback, low, high;
    const char* help; /* one line */
} thimble_controller_key;

typedef struct thimble_controller_settings {
    double sample_period_s;
    double position_scale; /* needle per hand */
    double force_scale;    /* force at the handle per force at the needle */
    double force_limit_N;  /* at the handle; what is beyond is cut off after force() */
    uint32_t value_count;
    const double* values;  /* one for each key, in the order of the table */
    const char* file;      /* of the plug-in, to find its data; "" for Thimble's own */
} thimble_controller_settings;

/* The handle at a sample. */
typedef struct thimble_handle {
    double time_s;              /* since the first sample of the trial */
    double elapsed_s;           /* since the sample before; 0 at the first */
    double position_hand_m;     /* the encoder's reading */
    double velocity_hand_m_per_s; /* estimated */
    double force_hand_N;        /* the force that was held until now */
} thimble_handle;

/* What the slave felt, as old as the network made it. Not yet limited. */
typedef struct thimble_feedback {
    double position_hand_m; /* where the needle was then, divided by position_scale */
    double force_total_hand_N, force_fixture_hand_N, force_tissue_hand_N;
    double age_s;   /* from the sample that it answers to now */
    uint32_t known; /* 0: nothing came yet, the network was silent for long, or the needle is held; all is 0 then */
} thimble_feedback;

/* What the ends tell each other beside position and force. Their meaning is
   the plug-in's own. Values stay within 1e6, sum within 1e12, energy_J from 0 to 1e12, `number` is below 2^32: what is beyond is cut. */
typedef struct thimble_packet {
    double value[8]; /* the first `count` */
    double sum, energy_J;
    uint32_t number, count;
} thimble_packet;

/* The master's sample, where it arrives at the slave. */
typedef struct thimble_command {
    double position_hand_m, velocity_hand_m_per_s, force_hand_N;
    uint32_t newer; /* 0: a later sample came before it */
} thimble_command;

/* What surrounds the needle when it is moved. */
typedef struct thimble_surroundings {
    double plane_hand_m;         /* the fixture's surface */
    double stiffness_hand_N_per_m; /* of the fixture; 0: there is none */
    double other_force_hand_N;   /* of tissue and others on the hand, one sample ago */
} thimble_surroundings;

/* NULL is allowed where it says so. `self` is what create or create_slave returned. */
typedef struct thimble_controller {
    uint32_t abi; /* THIMBLE_CONTROLLER_ABI */
    uint32_t capabilities;
    const char* name;
    const char* source; /* the publication of its equations, or NULL */
    const thimble_controller_key* keys;
    uint32_t key_count;

    /* The handle's end. create returns NULL if it refuses the settings. */
    void* (*create)(const thimble_controller_settings* settings);
    void (*destroy)(void* self);
    /* A trial begins: all that was learnt is forgotten. network_delay_s: there and back, as it is to be expected. */
    void (*start)(void* self, double network_delay_s);
    void (*network_changed)(void* self, double network_delay_s); /* or NULL */
    /* `out` is all 0, and goes to the slave if there are two ends. */
    void (*sample)(void* self, const thimble_handle* handle, thimble_packet* out);
    void (*receive)(void* self, const thimble_feedback* feedback);        /* or NULL: force() gets the newest */
    void (*receive_packet)(void* self, const thimble_packet* packet);     /* or NULL */
    void (*forget)(void* self); /* or NULL; the feedback became unknown */
    /* The force at the handle, from the newest feedback. With [codec] force = "deadband-linear" its force_total_hand_N is predicted
       between two packets; receive() gets none of these. Not a number counts as 0 N, and the user is told. */
    double (*force)(void* self, const thimble_feedback* newest);

    /* The slave's end, all NULL without THIMBLE_BOTH_ENDS. */
    void* (*create_slave)(const thimble_controller_settings* settings);
    void (*destroy_slave)(void* self);
    void (*start_slave)(void* self);
    /* Returns how often the needle is to be moved because of this message: 0 to 64 samples. */
    uint32_t (*receive_slave)(void* self, const thimble_command* command, const thimble_packet* packet);
    /* Moves the needle by one sample. Returns where it is then. */
    double (*step_slave)(void* self, const thimble_surroundings* surroundings);
    /* After the moves of a message. `out` goes back with the force. */
    void (*answer_slave)(void* self, const thimble_feedback* felt, thimble_packet* out);
    void (*hold_slave)(void* self); /* or NULL; commands stopped, every force is 0 */

    /* The part of the force that the hand gets, 0 to 1. The skin gets the rest. NULL: 1. Called before create.
       Its settings hold 0 for sample period, scales and limit. */
    double (*hand_share)(const thimble_controller_settings* settings);
} thimble_controller;

/* The only symbol that a plug-in exports. */
#if defined(_WIN32)
#define THIMBLE_CONTROLLER_EXPORT __declspec(dllexport)
#else
#define THIMBLE_CONTROLLER_EXPORT __attribute__((visibility("default")))
#endif
THIMBLE_CONTROLLER_EXPORT const thimble_controller* thimble_controller_table(void);

#ifdef __cplusplus
}
#endif

#endif
