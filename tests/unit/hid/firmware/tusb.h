// As much of TinyUSB as docs/examples/fingertip_board.c calls, played by the test.
#pragma once

#include <stdint.h>

typedef int hid_report_type_t;  // NOLINT: theirs

void tud_task();
bool tud_hid_ready();
bool tud_hid_report(uint8_t report_id, void const* report, uint16_t size);
