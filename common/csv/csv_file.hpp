// An output file that reports failure as Error instead of losing data silently.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

namespace thimble {

enum class IfExists { kRefuse, kReplace, kContinue };

class CsvFile {
  public:
    // Throws Error (usage) if the file exists and `if_exists` is kRefuse, or if it cannot be created. It empties
    // and takes a file that holds no more than `header` and that no program writes.
    CsvFile(const std::filesystem::path& path, IfExists if_exists, std::string_view header = {});

    bool is_new() const { return is_new_; }  // nothing in it yet: it needs a header
    // These throw Error (run failed), e.g. on a full disk; flush() and sync() also if the file was deleted. Later
    // calls throw too: the file may end in half a line, and another write could repeat text.
    void write(std::string_view text);
    void flush();  // hands the bytes to the kernel
    void sync();   // returns when the bytes are on the disk

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    void require_open() const;
    [[noreturn]] void fail(const char* doing);

    std::filesystem::path path_;
    std::unique_ptr<std::FILE, Close> file_;  // none after a failure
    bool is_new_ = true;
    bool had_a_place_ = true;  // in a folder, when it was opened
};

// Cuts a table back to its header and at most `lines` whole lines: what a program that was killed while it
// wrote leaves behind a last newline goes. Throws Error (run failed) if the file cannot be changed. Harmless
// for a file that is not there.
void keep_lines(const std::filesystem::path& path, std::size_t lines);

}  // namespace thimble
