#include "session/participant/phenotype.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;
using Columns = std::vector<std::string>;
using Line = PersonTable::Line;

// Explained by `meanings`, in the words of the first one who answers: the answers mean the same in each language.
void write_table(const PersonTable& table, const Json& meanings) {
    make_folder(table.file().parent_path());
    auto beside = table.file();
    beside.replace_extension(".json");
    std::error_code absent;
    if (!std::filesystem::exists(beside, absent)) write_whole(beside, json_text(meanings, 2) + '\n');
    table.write();
}

constexpr std::size_t kTime = 1, kFirstAnswer = 2;

std::filesystem::path file_of(const Dataset& dataset, std::string_view name) {
    return dataset.folder() / "phenotype" / fmt::format("{}.tsv", name);
}

void check_questions(const std::filesystem::path& file, const Columns& columns, const std::string& name) {
    std::string header;
    std::ifstream text(file, std::ios::binary);
    std::getline(text, header);
    if (header.ends_with('\r')) header.pop_back();
    if (header.empty() || header == fmt::format("{}", fmt::join(columns, "\t"))) return;
    throw Error(ExitCode::kData,
                "{}: the questions of questionnaire {} differ from those in this dataset: give the "
                "questionnaire another name, or use another --out",
                file.string(), name);
}

PersonTable table_of(const Dataset& dataset, const Questionnaire& form, std::uint32_t block) {
    Columns columns{"participant_id", "time_utc"};
    for (const Question& question : form.questions) columns.push_back(question.id);
    const bool blocks = form.when == AskedWhen::kBlock;
    const auto file = file_of(dataset, blocks ? fmt::format("{}_block{}", form.name, block) : form.name);
    check_questions(file, columns, form.name);
    return {file, std::move(columns)};
}

PersonTable consent_table(const Dataset& dataset) {
    return {file_of(dataset, "consent"), {"participant_id", "time_utc", "consent", "version"}};
}

Json meaning_of(const Question& q) {
    Json json{{"Description", q.text}};
    for (std::size_t i = 0; i < q.choices.size(); ++i) json["Levels"][std::to_string(i + 1)] = q.choices[i];
    if (q.low.empty() && q.high.empty()) return json;
    json["Levels"][fmt::format("{}", q.from)] = q.low;
    json["Levels"][fmt::format("{}", q.to)] = q.high;
    return json;
}

Json meanings_of(const Questionnaire& form) {
    const std::string& about = form.description.empty() ? form.name : form.description;
    Json json{{"MeasurementToolMetadata", {{"Description", about}}},
              {"time_utc", {{"Description", "When the last question was answered"}}}};
    for (const Question& question : form.questions) json[question.id] = meaning_of(question);
    return json;
}

Json meanings_of(const ConsentPage& page) {
    return {{"MeasurementToolMetadata", {{"Description", "Informed consent, given at the screen"}}},
            {"time_utc", {{"Description", "When the participant agreed"}}},
            {"consent", {{"Description", "The answer"}, {"Levels", {{"yes", page.agree}}}}},
            {"version", {{"Description", "Of the text that the participant read"}}}};
}

// open(table, its meanings) for each one of a session of so many blocks.
template <class Open>
void for_each_table(const Dataset& dataset, const PageSet& pages, std::uint32_t blocks, const Open& open) {
    if (pages.consent) open(consent_table(dataset), meanings_of(*pages.consent));
    for (const Questionnaire& form : pages.questionnaires) {
        const std::uint32_t tables = form.when == AskedWhen::kBlock ? blocks : 1;
        for (std::uint32_t block = 1; block <= tables; ++block)
            open(table_of(dataset, form, block), meanings_of(form));
    }
}

}  // namespace

void check_phenotype(const Dataset& dataset, const PageSet& pages, std::uint32_t blocks) {
    for_each_table(dataset, pages, blocks, [](const PersonTable&, const Json&) {});
}

void open_phenotype(const Dataset& dataset, const PageSet& pages, std::uint32_t blocks) {
    const TurnLock lock(dataset.description());
    const auto people = read_participants(dataset);
    for_each_table(dataset, pages, blocks, [&people](PersonTable table, const Json& meanings) {
        bool whole = is_table(table.file());
        for (const std::uint32_t participant : people) {
            whole = whole && table.find(participant) != nullptr;
            table.line_of(participant);
        }
        if (!whole) write_table(table, meanings);
    });
}

void write_answers(const Dataset& dataset, const Questionnaire& form, const FilledForm& filled) {
    const TurnLock lock(dataset.description());
    PersonTable table = table_of(dataset, form, filled.block);
    Line& line = table.line_of(filled.participant);
    line[kTime] = filled.time_utc;
    for (std::size_t i = 0; i < filled.answers.size(); ++i)
        if (filled.answers[i]) line[kFirstAnswer + i] = fmt::format("{}", *filled.answers[i]);
    write_table(table, meanings_of(form));
}

void write_consent(const Dataset& dataset, const ConsentPage& page, std::uint32_t participant,
                   const std::string& time_utc) {
    const TurnLock lock(dataset.description());
    PersonTable table = consent_table(dataset);
    table.line_of(participant) = {participant_id(participant), time_utc, "yes", tsv_text(page.version)};
    write_table(table, meanings_of(page));
}

bool is_filled(const Dataset& dataset, const Questionnaire& form, std::uint32_t participant,
               std::uint32_t block) {
    PersonTable table = table_of(dataset, form, block);
    const Line* const line = table.find(participant);
    return line != nullptr && (*line)[kTime] != kNotAvailable;
}

bool has_consented(const Dataset& dataset, const ConsentPage& page, std::uint32_t participant) {
    PersonTable table = consent_table(dataset);
    const Line* const line = table.find(participant);
    return line != nullptr && (*line)[kTime] != kNotAvailable && line->back() == tsv_text(page.version);
}

bool knows_person(const Dataset& dataset, std::uint32_t participant) {
    const auto people = read_participants(dataset);
    if (std::find(people.begin(), people.end(), participant) != people.end()) return true;
    PersonTable table = consent_table(dataset);
    const Line* const line = table.find(participant);
    return line != nullptr && (*line)[kTime] != kNotAvailable;
}

std::string utc_text(std::int64_t realtime_ns) {
    using namespace std::chrono;
    const sys_seconds time{floor<seconds>(nanoseconds{realtime_ns})};
    const auto day = floor<days>(time);
    const year_month_day date{day};
    const hh_mm_ss clock{time - day};
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                       clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

}  // namespace thimble
