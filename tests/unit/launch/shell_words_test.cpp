// Quoted text comes back whole from a real shell.
#include "session/launch/shell_words.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/process/child.hpp"

namespace thimble {
namespace {

std::string echoed(const std::string& words) {
    return run_program("sh", {"-c", "printf '%s|' " + words}, "/", "install a shell").output;
}

TEST(ShellWords, WhatAShellWouldTouchComesBackUntouched) {
    const std::vector<std::string> words{"",   "it's", "a b",     "$HOME",    "`id`", "\"", "\\", "*",  "~",
                                         "''", "a\nb", "$(exit)", "; exit 1", "!x",   "-n", "#",  "%s", "\t"};
    std::string expected;
    for (const std::string& word : words) expected += word + "|";
    EXPECT_EQ(echoed(shell_words(words)), expected);
}

RC_GTEST_PROP(ShellWords, AnyBytesButNulComeBack, ()) {
    auto word = *rc::gen::container<std::string>(rc::gen::inRange<char>(1, 127));
    RC_ASSERT(echoed(shell_word(word)) == word + "|");
}

}  // namespace
}  // namespace thimble
