// thimble.study: the trials of `thimble study`, kept in memory or written to a folder with all its tables.
#include "study/study.hpp"

#include "common/error.hpp"
#include "python/bindings.hpp"
#include "session/participant/dataset.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

struct Design {
    SystemSettings settings;
    std::vector<Protocol> protocols;
    bool paper = false;
    std::vector<SettingChange> changes{};
    std::vector<std::pair<std::string, std::string>> options{};  // for all_parameters()
};

void require_subjects(std::uint32_t subjects) {
    constexpr std::uint32_t kMost = 1'000'000;
    if (subjects < 1 || subjects > kMost)
        throw Error(ExitCode::kUsage, "subjects {}: has to be 1 to {}", subjects, kMost);
}

Design design_of(const py::object& session, const std::map<std::string, double>& changes,
                 std::optional<std::uint32_t> subjects, std::optional<std::uint64_t> seed,
                 const std::optional<std::string>& order) {
    Design design;
    design.settings = settings_from(session, changes);
    require_virtual_subjects(design.settings, "study");
    if (seed) {
        design.settings.plan.seed = *seed;
        design.options.emplace_back("session.seed", std::to_string(*seed));
    }
    if (order) {
        const auto known = parse_order(*order);
        if (!known)
            throw Error(ExitCode::kUsage, "order \"{}\": is neither \"shuffled\" nor \"williams\"", *order);
        design.settings.plan.order = *known;
        design.options.emplace_back("session.order", fmt::format("\"{}\"", *order));
    }
    if (subjects) {
        require_subjects(*subjects);
        if (!design.settings.protocol) design.settings.protocol.emplace();
        design.settings.protocol->subjects = *subjects;
        design.options.emplace_back("protocol.subjects", std::to_string(*subjects));
    }
    for (const auto& [key, value] : changes) design.changes.push_back({key, value});
    design.protocols = session_protocols(design.settings);
    design.paper = changes.empty() && !design.settings.file.empty() && is_paper_session(design.settings.file);
    return design;
}

std::string header() {
    std::string line;
    for (const auto& column : trial_columns()) line += (line.empty() ? "" : ",") + std::string(column.name);
    return line + '\n';
}

std::string table_of(const Design& design, unsigned jobs) {
    require_jobs(jobs);
    fmt::memory_buffer table;
    std::atomic<bool> stop = false;
    const std::vector<TrialConditions> trials = all_trials(design.protocols);
    interruptible(stop, [&] {
        return run_trials(design.settings, trials, jobs, &stop, [&](const TrialRecord& record) {
            write_fields(table, trial_columns(), make_row(record));
            table.push_back('\n');
        });
    });
    return header() + fmt::to_string(table);
}

std::string write_folder(const Design& design, const py::object& out, unsigned jobs, bool control,
                         bool trajectories, bool overwrite) {
    require_jobs(jobs);
    StudyOptions options;
    options.protocols = design.protocols;
    options.out = py::str(out).cast<std::string>();
    refuse_dataset(options.out);
    options.command = "thimble.study() in Python";
    if (!design.settings.file.empty())
        options.made_with = {{"all parameters of " + design.settings.file.filename().string(),
                              all_parameters(design.settings.file, design.changes, design.options)}};
    for (const SettingChange& change : design.changes)
        options.plan += fmt::format("changes: {} = {}\n", change.key, change.value);
    options.jobs = jobs;
    options.if_exists = overwrite ? IfExists::kReplace : IfExists::kRefuse;
    options.trajectories = trajectories;
    options.control = design.paper && control;
    options.paper_design = design.paper;
    std::atomic<bool> stop = false;
    options.stop = &stop;
    interruptible(stop, [&] { return run_study(design.settings, options).complete; });
    return options.out.string();
}

std::string study(const py::object& session, const std::map<std::string, double>& changes,
                  std::optional<std::uint32_t> subjects, std::optional<std::uint64_t> seed,
                  const std::optional<std::string>& order, unsigned jobs) {
    return table_of(design_of(session, changes, subjects, seed, order), jobs);
}

std::string study_folder(const py::object& session, const std::map<std::string, double>& changes,
                         std::optional<std::uint32_t> subjects, std::optional<std::uint64_t> seed,
                         const std::optional<std::string>& order, unsigned jobs, const py::object& out,
                         bool control, bool trajectories, bool overwrite) {
    return write_folder(design_of(session, changes, subjects, seed, order), out, jobs, control, trajectories,
                        overwrite);
}

}  // namespace

void require_jobs(unsigned jobs) {
    constexpr unsigned kMost = 1024;
    if (jobs > kMost) throw Error(ExitCode::kUsage, "jobs {}: has to be 0 (one per core) to {}", jobs, kMost);
}

void add_study(py::module_& module) {
    module.def("study_table", &study, "The text of trials.csv. thimble.study() is for users.");
    module.def("study_folder", &study_folder, "Writes a study's folder. thimble.study() is for users.");
}

}  // namespace thimble
