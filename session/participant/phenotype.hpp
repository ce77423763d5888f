// Answers of participants in the folder `phenotype` of a dataset, as BIDS has it: tables with their columns explained beside them. BIDS
// wants each participant once in each table. So a questionnaire about blocks has a table per block, and what is not answered, or not
// yet, is "n/a".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "session/participant/dataset.hpp"
#include "visual_node/page_set.hpp"

namespace thimble {

struct FilledForm {
    std::uint32_t participant = 0;
    std::uint32_t block = 0;  // that it is about; of AskedWhen::kBlock only
    std::string time_utc;
    std::vector<std::optional<double>> answers;  // nothing: the question was left out
};

// A line for each participant of the dataset in each table, which a session of so many blocks fills. Throws Error (data) if a table has
// other columns.
void open_phenotype(const Dataset& dataset, const PageSet& pages, std::uint32_t blocks);

// Before anything is written: throws the same Error.
void check_phenotype(const Dataset& dataset, const PageSet& pages, std::uint32_t blocks);

// On the disk when they return.
void write_answers(const Dataset& dataset, const Questionnaire& form, const FilledForm& filled);
void write_consent(const Dataset& dataset, const ConsentPage& page, std::uint32_t participant,
                   const std::string& time_utc);

bool is_filled(const Dataset& dataset, const Questionnaire& form, std::uint32_t participant,
               std::uint32_t block);
// To this version of the text.
bool has_consented(const Dataset& dataset, const ConsentPage& page, std::uint32_t participant);

// Whether a table names this participant as one who has taken part, or has agreed to.
bool knows_person(const Dataset& dataset, std::uint32_t participant);

// "2026-11-25T22:30:07Z" of nanoseconds since 1970.
std::string utc_text(std::int64_t realtime_ns);

}  // namespace thimble
