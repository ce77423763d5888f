// Results go to standard output. If they get lost there, the program reports it and fails.
#pragma once

#include "common/error.hpp"

namespace thimble {

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
