// A page set: everything that a subject reads, in one language. Pages ([instructions]), a consent page, and questionnaires, which are
// answered at the subject's screen. docs/real-subjects.md describes the file.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "visual_node/instructions.hpp"

namespace thimble {

enum class QuestionKind : std::uint8_t {
    kScale,   // a visual-analogue scale: a place between two ends
    kLikert,  // 1 to `to`, with words at both ends
    kChoice,  // one of `choices`, counted from 1
    kNumber,  // a whole number
};

struct Question {
    std::string id;    // the column of its answers
    std::string text;  // as the subject reads it
    QuestionKind kind = QuestionKind::kScale;
    std::vector<std::string> choices;  // kChoice
    std::string low, high;             // words at both ends
    double from = 0, to = 100, step = 1;

    bool accepts(double value) const {
        return value >= from && value <= to && std::abs(std::remainder(value - from, step)) < 1e-6;
    }
};

enum class AskedWhen : std::uint8_t {
    kBlock,
    kStart,
    kEnd
};  // after each block, before all trials, after them

struct Questionnaire {
    std::string name;  // of its table, phenotype/NAME.tsv
    std::string title, description;
    AskedWhen when = AskedWhen::kBlock;
    std::vector<Question> questions;
};

struct ConsentPage {
    std::string version, title, text, agree, decline;

    static constexpr double kAgreed = 1;  // the first choice
};

// A question as the screen shows it.
struct ShownQuestion {
    std::string title;
    Question question;
};

struct PageSet {
    Instructions instructions;
    std::optional<ConsentPage> consent;
    std::vector<Questionnaire> questionnaires;

    // All its characters, which the font must have.
    std::string text() const;
    // Of the message Page, from 1: the consent page, if there is one, then question after question.
    std::vector<ShownQuestion> shown() const;
    // The number there of a questionnaire's first question.
    std::uint32_t first_number(std::size_t questionnaire) const;
    // Of everything that shown() has: two programs whose page sets differ in one word have another.
    std::uint32_t checksum() const;
};

// [instructions] of a session file, with the page set that it names. Throws Error (usage).
PageSet read_pages(const ConfigFile& session);
// A page set's own file, whole or for a description.
PageSet read_page_set(const ConfigFile& file);

struct BuiltInPages {
    std::string_view name;  // "it.toml"
    std::string_view text;
};
const std::vector<BuiltInPages>& built_in_pages();  // deploy/pages at build time

}  // namespace thimble
