// Every exchange of stamps of a session, raw, as CSV: nodes/clocks_<delay>ms.csv of a run. Every figure about clocks is computed from this file, so a reader can compute it again.
#pragma once

#include <filesystem>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "common/messages.hpp"
#include "session/clocks/clock_exchange.hpp"

namespace thimble {

struct ClockRecord {
    Role node = Role::kMaster;  // whose clock is the far one; the near one is the session's
    ClockExchange exchange;
};

class ClockWriter {
  public:
    // Replaces an earlier file. Throws Error (usage) if it cannot be created.
    explicit ClockWriter(const std::filesystem::path& path);
    void append(Role node, const ClockExchange& exchange);
    void flush() { file_.flush(); }

  private:
    CsvFile file_;
};

// Throws Error (data) naming line and column of what cannot be read.
std::vector<ClockRecord> read_clock_file(const std::filesystem::path& path);

}  // namespace thimble
