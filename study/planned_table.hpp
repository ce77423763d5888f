// A table that grows in the order of a plan, NAME.csv, beside the text of that plan, NAME.txt. Its bytes depend on nothing but the
// plan, and a run that was interrupted or killed is gone on with.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// Of a plan's text: the bytes of the session file, and the hash of each file that it names (scene, trace, page, plug-in).
std::string session_text(const SystemSettings& settings);

// Throws Error (usage): the text is another, or the file is missing. `what` is for messages: "map".
void require_plan(const std::filesystem::path& plan_file, const std::string& what, const std::string& plan);

// Begins the table of a plan, or goes on with it (kContinue): then the table is there, and in `plan_file` the text of its plan.
// `results` are files in its folder that are made of the table: a table that begins removes those of an earlier one. Throws Error
// (usage) if the folder holds one already, or one of another plan.
void open_plan(const std::filesystem::path& table, const std::filesystem::path& plan_file,
               const std::string& what, const std::string& plan, IfExists if_exists,
               const std::vector<std::string>& results = {});

class PlannedTable {
  public:
    // In `folder`, made if missing. kContinue goes on behind the whole rows that are there, if they are of the same plan. `what` is
    // for messages: "map". `results`: as of open_plan. Throws Error (usage, run failed).
    PlannedTable(const std::filesystem::path& folder, const std::string& name, const std::string& what,
                 const std::string& plan, std::string_view header, IfExists if_exists,
                 const std::vector<std::string>& results = {});

    std::size_t done() const { return done_; }  // rows, from the first on
    void append(std::string_view rows);         // whole lines; they are with the kernel then

  private:
    std::size_t done_;
    CsvFile file_;
};

}  // namespace thimble
