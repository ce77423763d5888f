#include "session/log/logged_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "common/decimal_text.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

// The last folders of a path and its own name: "a/nodes/session_50ms" with two.
std::string end_of(const std::filesystem::path& path, std::size_t folders, bool with_extension) {
    const std::filesystem::path parent = path.parent_path();
    std::filesystem::path end = with_extension ? path.filename() : path.stem();
    for (auto part = parent.end(); folders > 0 && part != parent.begin(); --folders)
        if (*--part != parent.root_path()) end = *part / end;
    return end.string();
}

// A name that none of the others has.
std::string name_among(const std::vector<std::filesystem::path>& all, std::size_t own) {
    std::size_t folders = 0;
    bool with_extension = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i == own || all[i].stem() != all[own].stem()) continue;
        if (all[i] == all[own])
            throw Error(ExitCode::kUsage, "{}: is named twice; name each log once", all[i].string());
        if (all[i].parent_path() == all[own].parent_path()) {
            with_extension = true;
            continue;
        }
        while (end_of(all[i], folders, false) == end_of(all[own], folders, false)) ++folders;
    }
    return end_of(all[own], folders, with_extension);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
    const auto fail = [&](const char* why) {
        throw Error(ExitCode::kData, "{}: cannot read this log: {}; is the name right?", path.string(), why);
    };
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) fail(std::strerror(errno));
    struct stat about {};
    const bool regular = fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode);
    const auto size = static_cast<std::size_t>(regular ? about.st_size : 0);
    void* mapped = size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
    const int error = errno;
    close(descriptor);
    if (!regular) fail("it is not a regular file");
    if (mapped == MAP_FAILED) fail(std::strerror(error));
    bytes_ = {static_cast<const std::uint8_t*>(mapped), size};
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

class LoggedFile::Reading final : public McapVisitor {
  public:
    explicit Reading(LoggedFile& file) : file_(file) {}
    void library(std::string_view name) override { file_.library_ = name; }
    void channel(const McapChannel& c) override {
        file_.topics_[c.id] = {c.topic, value_of(c.metadata, "direction") == "sent", c.schema != 0, 0};
    }
    void message(const McapMessage& m) override {
        ++file_.topics_[m.channel].messages;
        file_.first_ns_ = first_ ? m.log_time_ns : std::min(file_.first_ns_, m.log_time_ns);
        file_.last_ns_ = std::max(file_.last_ns_, m.log_time_ns);
        first_ = false;
    }
    void metadata(const McapMetadata& m) override {
        file_.metadata_.push_back({std::string(m.name), m.pairs});
    }
    void attachment(const McapAttachment& a) override {
        file_.attachments_.push_back({std::string(a.name), a.data.size()});
    }

  private:
    LoggedFile& file_;
    bool first_ = true;
};

LoggedFile::LoggedFile(const std::filesystem::path& path, std::string name)
    : path_(path), name_(std::move(name)), file_(path) {
    Reading reading(*this);
    scan_ = scan_mcap(file_.bytes(), reading);
    if (scan_.begins) return;
    throw Error(
        ExitCode::kData,
        "{}: is not an MCAP file, or is empty; thimble log reads files that end in .mcap (docs/log.md)",
        path.string());
}

std::string LoggedFile::value(std::string_view record, std::string_view key) const {
    const auto found =
        std::find_if(metadata_.begin(), metadata_.end(), [&](const auto& m) { return m.name == record; });
    return found == metadata_.end() ? std::string{} : std::string(value_of(found->pairs, key));
}

std::uint64_t LoggedFile::lost() const {
    std::uint64_t lost = 0;
    for (const LogMetadata& m : metadata_) {
        lost = std::max(lost, parse_whole<std::uint64_t>(value_of(m.pairs, "messages_lost")).value_or(0));
    }
    return lost;
}

void LoggedFile::for_each(const Use& use) const {
    class Passing final : public McapVisitor {
      public:
        Passing(const LoggedFile& file, const Use& pass) : file_(file), pass_(pass) {}
        void message(const McapMessage& m) override { pass_(file_.topics_.at(m.channel), m); }

      private:
        const LoggedFile& file_;
        const Use& pass_;
    };
    Passing passing(*this, use);
    scan_mcap(bytes(), passing);
}

std::vector<std::unique_ptr<LoggedFile>> open_logs(const std::vector<std::string>& paths) {
    std::vector<std::filesystem::path> all;
    all.reserve(paths.size());
    for (const std::string& path : paths) all.push_back(std::filesystem::absolute(path).lexically_normal());
    std::vector<std::unique_ptr<LoggedFile>> files;
    files.reserve(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i)
        files.push_back(std::make_unique<LoggedFile>(paths[i], name_among(all, i)));
    return files;
}

}  // namespace thimble
