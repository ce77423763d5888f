// The three standard descriptors: none of them stays closed, a slow reader of stderr never blocks the program, and results that get
// lost on stdout are noticed.
#pragma once

#include <string>
#include <string_view>

#include "common/error.hpp"
#include "common/time.hpp"

namespace thimble {

// Opens /dev/null in the place of each one that is closed, or the next file would take its number. Comes first in every program.
void open_standard_descriptors();

// A separate thread writes these words to stderr, so that a held terminal (Ctrl-S) or a full pipe blocks no loop. A full queue
// drops messages. The thread writes their number when there is room again.
void write_stderr(std::string_view words);
// Waits until all words are written, at most `limit`. False: some are not.
bool stderr_written_within(Duration limit);
// spdlog says its words that way, too, in the name of this program.
void log_to_stderr(const std::string& program);

// Results go to standard output. If they get lost there, the program reports it and fails.

// Ends the program: no reader is left. settle_results() reports the reason.
class ResultsLost : public Error {
  public:
    ResultsLost() : Error(ExitCode::kRunFailed, "standard output cannot be written") {}
};

// Writes the buffered results, for a loop that prints while there is a reader. Throws ResultsLost.
void flush_results();

// Writes the buffered results at the end of a program. If results are lost, exit code 0 becomes 1, and standard error names the
// reason. There is no message if the reader has closed its pipe (`| head`).
int settle_results(int exit_code);

}  // namespace thimble
