// Files: a whole text written at once, a folder made, a descriptor that closes itself. And lines of text cut into parts.
#pragma once

#include <filesystem>
#include <string_view>
#include <unistd.h>

#include <boost/core/noncopyable.hpp>

namespace thimble {

// Replaces the file. Throws Error (run failed) naming it if it cannot be written to its end.
void write_text_file(const std::filesystem::path& path, std::string_view text);

// With those on the way; an empty path is where the program is. Throws Error (usage) naming it if it cannot be made, or the file that
// lies there.
void make_folder(const std::filesystem::path& folder);

// Throws Error (usage) if a folder lies where `file` is to be read or written.
void refuse_folder(const std::filesystem::path& file);

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

}  // namespace thimble
