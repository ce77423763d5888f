// The board's side of docs/board-protocol.md for TinyUSB (Raspberry Pi Pico and many others). now_ms, press and measured_mN
// are your hardware's; the descriptor's bytes stand in the page.
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "tusb.h"

enum { COMMAND = 1, STATUS = 2, VERSION = 1, BYTES = 10, MOST_MN = 1500, WATCHDOG_MS = 50, STATUS_MS = 10 };

uint32_t now_ms(void);
void press(int finger, uint16_t force_mN);
uint16_t measured_mN(int finger);

uint8_t board_fault;  // what your hardware finds wrong, 0: nothing

static uint8_t sequence;
static bool pressing, late, answer;
static uint16_t wanted_mN[2];  // index finger, thumb
static uint32_t heard_ms, told_ms;

static uint8_t crc8(const uint8_t* bytes, int count) {
    unsigned crc = 0;
    for (int i = 0; i < count; ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80) != 0 ? (crc << 1) ^ 0x07 : crc << 1;
        crc &= 0xff;
    }
    return (uint8_t)crc;
}

static void slack(void) {
    pressing = false;
    wanted_mN[0] = wanted_mN[1] = 0;
}

// TinyUSB calls this with a report from the computer: from the interrupt endpoint with its number in the first byte and
// report_id 0, from the control endpoint without it.
void tud_hid_set_report_cb(uint8_t instance, uint8_t report_id, hid_report_type_t type, uint8_t const* data,
                           uint16_t size) {
    (void)instance;
    (void)type;
    uint8_t report[BYTES] = {report_id};
    const uint16_t missing = report_id == 0 ? 0 : 1;
    if (size + missing != BYTES) return;
    memcpy(report + missing, data, size);
    if (report[0] != COMMAND || report[1] != VERSION || crc8(report, BYTES - 1) != report[BYTES - 1]) return;
    heard_ms = now_ms();
    sequence = report[2];
    late = false;
    answer = true;
    slack();
    if ((report[3] & 1) == 0 || board_fault != 0) return;
    pressing = true;
    for (int finger = 0; finger < 2; ++finger) {
        const unsigned asked = report[4 + 2 * finger] + 256u * report[5 + 2 * finger];
        wanted_mN[finger] = asked < MOST_MN ? (uint16_t)asked : (uint16_t)MOST_MN;
    }
}

static void tell(void) {
    uint8_t report[BYTES] = {STATUS, VERSION, sequence};
    report[3] = (uint8_t)((pressing ? 1 : 0) | (late ? 2 : 0));
    for (int finger = 0; finger < 2; ++finger) {
        const uint16_t mN = measured_mN(finger);
        report[4 + 2 * finger] = (uint8_t)(mN & 0xff);
        report[5 + 2 * finger] = (uint8_t)(mN >> 8);
    }
    report[8] = board_fault;
    report[9] = crc8(report, BYTES - 1);
    tud_hid_report(STATUS, report + 1, BYTES - 1);  // which puts the number before them
}

// Call it at least once a millisecond.
void board_task(void) {
    tud_task();
    const uint32_t now = now_ms();
    if (pressing && now - heard_ms > WATCHDOG_MS) {
        slack();
        late = true;
    }
    if (board_fault != 0) slack();
    for (int finger = 0; finger < 2; ++finger) press(finger, wanted_mN[finger]);
    if ((!answer && now - told_ms < STATUS_MS) || !tud_hid_ready()) return;
    tell();
    answer = false;
    told_ms = now;
}
