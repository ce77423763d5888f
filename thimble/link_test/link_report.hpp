// A link test in words and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "thimble/link_test/link_figures.hpp"
#include "thimble/link_test/verdict.hpp"

namespace thimble {

struct LinkReport {
    LinkFigures link;
    std::vector<ModalityVerdict> verdicts;
    std::string chrony;  // a sentence
};

std::string to_text(const LinkReport& report);
nlohmann::ordered_json to_json(const LinkReport& report);

// 3 (network) if a port does not answer or the session's datagrams do not pass, 1 if a modality does not fit, else 0.
ExitCode exit_code(const LinkReport& report);
// Of any port that was tried.
std::size_t largest_session_datagram(const LinkFigures& link);

}  // namespace thimble
