// Files: a whole text written at once, a folder made, a descriptor that closes itself. And lines of text cut into parts.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <limits>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/error.hpp"

namespace thimble {

// Replaces the file. Throws Error naming it: as fail_to_create() does; run failed, if it cannot be written to its end.
void write_text_file(const std::filesystem::path& path, std::string_view text);

// All of it to an open file. False: errno says why.
bool write_all(int descriptor, std::string_view text);

// Opens a file to write at that place itself, never through a symbolic link, and makes it if it is not there. It follows links
// to streams in /dev only. `flags`, and the result: open(2).
int open_to_write(const std::filesystem::path& file, int flags);
// Throws Error with the reason (an errno) and what to do: usage for a symbolic link, run failed where the system has no room,
// else `otherwise`.
[[noreturn]] void fail_to_create(const std::filesystem::path& file, int error,
                                 ExitCode otherwise = ExitCode::kUsage);
// "; raise 'ulimit -n'" where the program may open no more, else nothing.
const char* descriptor_advice(int error);

// Takes away an earlier result, if there is one. Throws Error (usage) naming it if that is not allowed.
void remove_file(const std::filesystem::path& file);

// The file's bytes; none, if it cannot be opened. Throws Error (data) as read_to_end() does.
std::string read_text_file(const std::filesystem::path& path);
// The first line without its end; empty if the file cannot be opened or read.
std::string first_line(const std::filesystem::path& file);
// The whole file. Throws Error (data) if it cannot be read or is larger than `most`.
std::string read_whole_file(const std::filesystem::path& path, std::size_t most = std::size_t{512} << 20);

// The rest of that file's stream, but no more than a byte beyond `most`. Throws Error (data) naming the file if the system fails to
// read on: a stream by itself takes that for the file's end.
std::string read_to_end(std::istream& stream, const std::filesystem::path& file,
                        std::size_t most = std::numeric_limits<std::size_t>::max() - 1);
// Throws that Error, after reads by other means.
void refuse_half_read(const std::istream& stream, const std::filesystem::path& file);

// In hexadecimal, as sha256sum(1) prints it; empty if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

// With those on the way; an empty path is where the program is. Throws Error (usage) naming it if it cannot be made, or the file that
// lies there.
void make_folder(const std::filesystem::path& folder);

// Throws Error with `code` if a folder lies where `file` is to be read or written: it opens as a stream, too.
void refuse_folder(const std::filesystem::path& file, ExitCode code = ExitCode::kUsage);

// Closes what it holds, unless that is negative.
class FileDescriptor : boost::noncopyable {
  public:
    explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
    ~FileDescriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    int get() const { return descriptor_; }

  private:
    int descriptor_;
};

// Cuts `text` behind the next `end` and returns what stood before it; all of it where there is none.
inline std::string_view take_until(std::string_view& text, char end) {
    const std::size_t at = text.find(end);
    const std::string_view part = text.substr(0, at);
    text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
    return part;
}

// Words between blanks, tabs and ends of lines.
std::vector<std::string_view> words_of(std::string_view text);
// Replaces `parts` by what stands between the separators.
void split_at(char separator, std::string_view text, std::vector<std::string_view>& parts);

}  // namespace thimble
