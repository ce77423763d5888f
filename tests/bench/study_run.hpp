// Runs a study of thimble-bench in a folder of its own and reads what it wrote.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/process/child.hpp"

namespace thimble::test {

using Row = std::map<std::string, std::string>;  // by the column's name

inline std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    return fields;
}

class StudyRun : public testing::Test {
  protected:
    StudyRun() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) /
                  (std::string("thimble_") + test->test_suite_name() + "_" + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~StudyRun() override { std::filesystem::remove_all(folder_); }

    ProgramResult study(const std::string& name, std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), name);
        return run_program((std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-bench").string(), arguments,
                           folder_, "build thimble-bench");
    }
    std::string text(const std::string& file) const {
        std::ifstream in(folder_ / file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    }
    std::vector<Row> table(const std::string& file) const {
        std::istringstream stream(text(file));
        std::string line;
        std::getline(stream, line);
        const std::vector<std::string> names = split(line);
        std::vector<Row> rows;
        while (std::getline(stream, line)) {
            const std::vector<std::string> fields = split(line);
            Row row;
            for (std::size_t i = 0; i < fields.size() && i < names.size(); ++i) row[names[i]] = fields[i];
            rows.push_back(row);
        }
        return rows;
    }

    std::filesystem::path folder_;
};

inline double number(const Row& row, const std::string& column) { return std::stod(row.at(column)); }

}  // namespace thimble::test
