#include <algorithm>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "study/study.hpp"

namespace thimble {
namespace {

constexpr const char* kHeader =
    "cohort,subject,speed_insert_needle_m_per_s,arm_stiffness_N_per_m,grip_stiffness_N_per_m,criterion_N,"
    "sway_m,push_m,reaction_factor,reaction_factor_HF,reaction_factor_CF,reaction_factor_CCF,reaction_factor_"
    "VF,seed\n";

std::string line_of(const Subject& drawn, std::uint32_t cohort, std::uint32_t subject, std::uint64_t seed) {
    std::string line = fmt::format("{},{}", cohort, subject);
    const auto add = [&line](double value) {
        line += ',';
        write_number(std::back_inserter(line), value);
    };
    for (const double value :
         {drawn.speed_insert_needle_m_per_s, drawn.arm_stiffness_N_per_m, drawn.grip_stiffness_N_per_m,
          drawn.criterion_N, drawn.sway_m, drawn.push_m, drawn.reaction_factor}) {
        add(value);
    }
    for (const double factor : drawn.reaction_modality_factor) add(factor);
    return line + fmt::format(",{}\n", seed);
}

}  // namespace

void write_subjects(const std::filesystem::path& path, const OperatorParameters& parameters,
                    const std::vector<Protocol>& protocols) {
    std::map<std::uint32_t, std::uint32_t> cohorts;  // its number of subjects
    for (const Protocol& protocol : protocols) {
        std::uint32_t& subjects = cohorts[cohort_of(protocol.experiment)];
        subjects = std::max(subjects, protocol.subjects);
    }
    CsvFile file(path, IfExists::kReplace);
    file.write(kHeader);
    for (const auto& [cohort, subjects] : cohorts) {
        const std::uint64_t seed = protocols.front().seed;
        for (std::uint32_t subject = 1; subject <= subjects; ++subject) {
            file.write(line_of(draw_subject(parameters, seed, cohort, subject), cohort, subject, seed));
        }
    }
    file.sync();
}

}  // namespace thimble
