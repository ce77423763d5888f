#include "visual_node/page_set.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {
namespace {

using Names = std::set<std::string>;

// It is the name of a file or of a column.
void check_name(const ConfigTable& table, const char* key, const std::string& name, Names& taken) {
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!plain) table.fail(key, "is \"{}\": use small letters, digits and '_' only", name);
    if (!taken.insert(name).second) table.fail(key, "\"{}\" is used twice: choose another", name);
}

std::string read_own_text(const ConfigTable& table, const char* key, std::string_view help) {
    return read_page_text(table, key, help).value_or("");
}

void need(const ConfigTable& table, const char* key, const std::string& text) {
    if (text.empty()) table.fail(key, "is missing or empty");
}

Question read_question(const ConfigTable& table) {
    static constexpr double kMost = 1e6;
    Question q;
    table.read("id", q.id, "Name of the column with the answers: small letters, digits and '_'.");
    q.text = read_own_text(table, "text", "Question for the subject.");
    table.read("kind", q.kind, {"scale", "likert", "choice", "number"}, "Kind of answer.");
    q.low = read_own_text(table, "low", "scale, likert: label of the lower end.");
    q.high = read_own_text(table, "high", "scale, likert: label of the upper end.");
    table.read("choices", q.choices, "choice: 2 to 9 answers, of which the subject chooses one.");
    if (q.kind == QuestionKind::kLikert) q.to = 7;
    table.read("from", q.from, -kMost, kMost,
               "scale, number: smallest value; likert and choice count from 1.");
    table.read("to", q.to, -kMost, kMost,
               "scale, number: largest value; likert: number of points, default 7.");
    table.read("step", q.step, 1e-3, kMost, "scale: distance between two positions that can be chosen.");
    const bool counts = q.kind == QuestionKind::kLikert || q.kind == QuestionKind::kChoice;
    if (counts) q.from = 1;
    if (counts || q.kind == QuestionKind::kNumber) q.step = 1;
    if (q.kind == QuestionKind::kChoice) q.to = static_cast<double>(q.choices.size());
    return q;
}

void refuse_unused(const ConfigTable& table, QuestionKind kind) {
    const bool scale = kind == QuestionKind::kScale, likert = kind == QuestionKind::kLikert,
               number = kind == QuestionKind::kNumber;
    for (const auto& [key, used] : {std::pair{"from", scale || number},
                                    {"step", scale},
                                    {"to", scale || likert || number},
                                    {"low", scale || likert},
                                    {"high", scale || likert}}) {
        if (!used && table.has(key)) table.fail(key, "has no effect with this kind of question: remove it");
    }
}

void check_question(const ConfigTable& table, const Question& q, Names& taken) {
    refuse_unused(table, q.kind);
    check_name(table, "id", q.id, taken);
    need(table, "text", q.text);
    for (const std::string& choice : q.choices) {
        need(table, "choices", choice);
        refuse_right_to_left(table, "choices", choice);
    }
    const bool chooses = q.kind == QuestionKind::kChoice;
    if (chooses && (q.choices.size() < 2 || q.choices.size() > 9))
        table.fail("choices", "a choice has 2 to 9 texts");
    if (!chooses && !q.choices.empty()) table.fail("choices", "works with kind = \"choice\" only");
    if (q.kind == QuestionKind::kLikert && (q.to < 2 || q.to > 9 || q.to != std::floor(q.to)))
        table.fail("to", "a likert scale has 2 to 9 points");
    if (q.kind == QuestionKind::kNumber && (q.from != std::floor(q.from) || q.to != std::floor(q.to)))
        table.fail("to", "must be a whole number, as must its limits");
    if (q.from >= q.to) table.fail("to", "is {}, and from is {}: it must be greater", q.to, q.from);
    if (!q.accepts(q.to)) table.fail("step", "does not divide the range between both ends evenly");
}

Questionnaire read_questionnaire(const ConfigTable& table) {
    Questionnaire form;
    table.read("name", form.name,
               "Name of the table with the answers: phenotype/NAME.tsv, or NAME_block1.tsv and so on.");
    form.title = read_own_text(table, "title", "Text above each question.");
    table.read("description", form.description, "Description for those who read the data.");
    table.read("when", form.when, {"block", "start", "end"},
               "When the questionnaire appears: after each block of trials except practice; before the first "
               "trial; or after the last one.");
    for (const ConfigTable& entry : table.tables("question", [](const ConfigTable& t) { read_question(t); }))
        form.questions.push_back(read_question(entry));
    return form;
}

void check_questionnaire(const ConfigTable& table, const Questionnaire& form, Names& taken) {
    check_name(table, "name", form.name, taken);
    const std::vector<ConfigTable> entries = table.tables("question", [](const ConfigTable&) {});
    if (entries.empty()) table.fail("question", "is missing: a questionnaire has at least one");
    Names ids{"participant_id", "time_utc"};  // columns that each table has
    for (std::size_t i = 0; i < entries.size(); ++i) check_question(entries[i], form.questions[i], ids);
}

ConsentPage read_consent(const ConfigTable& table) {
    ConsentPage page;
    table.read("version", page.version,
               "Version of the text, as the ethics board approved it; it is recorded.");
    page.title = read_own_text(table, "title", "Title above the text.");
    page.text = read_own_text(table, "text", "Text that the participant agrees to.");
    page.agree = read_own_text(table, "agree", "Answer that lets the session begin.");
    page.decline = read_own_text(table, "decline", "Answer that ends the session.");
    return page;
}

void check_consent(const ConfigTable& table, const ConsentPage& page) {
    need(table, "version", page.version);
    need(table, "text", page.text);
    need(table, "agree", page.agree);
    need(table, "decline", page.decline);
}

Question consent_question(const ConsentPage& page) {
    Question question;
    question.id = "consent";
    question.text = page.text;
    question.kind = QuestionKind::kChoice;
    question.choices = {page.agree, page.decline};
    question.from = 1;
    question.to = 2;
    return question;
}

PageSet load_page_set(const std::filesystem::path& path) {
    PageSet pages;
    const auto read = [&pages](const ConfigFile& file) {
        file.read_all([&] { pages = read_page_set(file); });
        return pages;
    };
    if (std::filesystem::exists(path)) return read(ConfigFile::load(path));
    std::vector<std::string_view> names;
    for (const BuiltInPages& set : built_in_pages()) {
        if (path == set.name) return read(ConfigFile::parse(set.text, set.name));
        names.push_back(set.name);
    }
    throw Error(ExitCode::kUsage,
                "[instructions] pages is {}: there is no such file; the built-in ones are {}", path.string(),
                fmt::join(names, ", "));
}

// A brace in [protocol] break_text begins no placeholder.
std::string break_page(const ConfigTable& protocol) {
    const std::string text = read_break_text(protocol);
    refuse_right_to_left(protocol, "break_text", text);
    std::string page;
    for (const char c : text) page.append(c == '{' || c == '}' ? 2U : 1U, c);
    return page + "\n{break_time} to go";
}

}  // namespace

std::string PageSet::text() const {
    std::string all = instructions.text();
    for (const ShownQuestion& one : shown()) {
        const Question& q = one.question;
        all +=
            fmt::format("{}\n{}\n{}\n{}\n{}\n", one.title, q.text, q.low, q.high, fmt::join(q.choices, "\n"));
    }
    return all;
}

std::vector<ShownQuestion> PageSet::shown() const {
    std::vector<ShownQuestion> all;
    if (consent) all.push_back({consent->title, consent_question(*consent)});
    for (const Questionnaire& form : questionnaires)
        for (const Question& question : form.questions) all.push_back({form.title, question});
    return all;
}

// FNV-1a: it finds two page sets that a person has edited apart. It is no protection.
std::uint32_t PageSet::checksum() const {
    std::uint32_t sum = 2166136261U;
    const auto add = [&sum](std::string_view text) {
        for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 16777619U;
        sum = (sum ^ 0xFFU) * 16777619U;  // no byte of UTF-8: texts do not run into each other
    };
    for (const ShownQuestion& one : shown()) {
        const Question& q = one.question;
        for (const std::string& text : {one.title, q.id, q.text, q.low, q.high}) add(text);
        for (const std::string& choice : q.choices) add(choice);
        add(fmt::format("{} {} {} {}", static_cast<int>(q.kind), q.from, q.to, q.step));
    }
    return sum;
}

std::uint32_t PageSet::first_number(std::size_t questionnaire) const {
    std::size_t number = consent ? 2 : 1;
    for (std::size_t i = 0; i < questionnaire; ++i) number += questionnaires[i].questions.size();
    return static_cast<std::uint32_t>(number);
}

PageSet read_page_set(const ConfigFile& file) {
    PageSet pages;
    pages.instructions = read_instructions(file.table("instructions"));
    const ConfigTable consent = file.table("consent");
    const ConsentPage page = read_consent(consent);
    if (file.root().has("consent")) {
        check_consent(consent, page);
        pages.consent = page;
    }
    Names names{"consent"};
    const auto describe = [](const ConfigTable& table) { read_questionnaire(table); };
    for (const ConfigTable& table : file.root().tables("questionnaire", describe)) {
        pages.questionnaires.push_back(read_questionnaire(table));
        check_questionnaire(table, pages.questionnaires.back(), names);
    }
    return pages;
}

PageSet read_pages(const ConfigFile& session) {
    const ConfigTable table = session.table("instructions");
    PageSet pages;
    std::string name;
    table.read("pages", name,
               "Set of pages: a file beside this one, or a built-in one such as \"it.toml\" "
               "(docs/real-subjects.md). The keys below replace its texts.");
    if (!name.empty()) {
        const std::filesystem::path beside = session.folder() / name;
        const bool found = std::filesystem::exists(beside);
        if (found) session.uses(name);
        table.load("pages", [&] { pages = load_page_set(found ? beside : std::filesystem::path(name)); });
    }
    pages.instructions = read_instructions(table, std::move(pages.instructions));
    auto& rest = pages.instructions.pages[static_cast<std::size_t>(PageKind::kBreak)].body;
    if (!rest) rest = break_page(session.table("protocol"));
    return pages;
}

}  // namespace thimble
