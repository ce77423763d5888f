// Results go to standard output. Whoever asked for them hears of it if they did not get there.
#pragma once

#include "common/error.hpp"

namespace thimble {

// The program ends because nobody can be told more; settle_results() says why.
class ResultsLost : public Error {
  public:
    ResultsLost() : Error(ExitCode::kRunFailed, "standard output cannot be written") {}
};

// For a loop that prints as long as somebody reads: hands the results on. Throws ResultsLost.
void flush_results();

// At the end of a program with this exit code: hands the results on. If some are lost, 0 becomes 1, and the reason is said
// on standard error. A reader that has closed its pipe (`| head`) has what it wanted: then nothing is said.
int settle_results(int exit_code);

}  // namespace thimble
