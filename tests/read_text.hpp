#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

namespace thimble {

inline std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Of a file that must be there: two files that are missing would be equal.
inline std::string whole_text(const std::filesystem::path& path) {
    std::string text = read_text(path);
    EXPECT_FALSE(text.empty()) << path;
    return text;
}

}  // namespace thimble
