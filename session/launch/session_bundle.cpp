#include <algorithm>
#include <cctype>
#include <fstream>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/launch/remote_starter.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& session, const std::string& name, const char* why) {
    throw Error(ExitCode::kUsage,
                "{}: names the file '{}', which {}; put the file beside the session file and use its plain "
                "name, then it is sent to the other machines",
                session.string(), name, why);
}

bool leads_out(const fs::path& name) {
    return name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
}

// It has to stand in one line, and a shell reads that.
bool is_odd(const std::string& name) {
    const auto control = [](unsigned char c) { return std::iscntrl(c) != 0; };
    return name.front() == ' ' || name.back() == ' ' || name.back() == '/' ||
           std::any_of(name.begin(), name.end(), control);
}

std::string read_file(const fs::path& session, const std::string& name) {
    const fs::path path = session.parent_path() / name;
    std::ifstream file(path, std::ios::binary);
    if (!file || !fs::is_regular_file(path)) refuse(session, name, "is not beside it");
    return read_to_end(file, path);
}

}  // namespace

SessionBundle make_bundle(const fs::path& session) {
    const ConfigFile file = ConfigFile::load(session);
    read_system_settings(file);  // which reads, and so names, every file
    SessionBundle bundle;
    const std::string own = session.filename().string();
    if (is_odd(own)) refuse(session, own, "has blanks at the ends of its name, or control characters");
    bundle.files.push_back({own, read_file(session, own)});
    for (const std::string& name : file.used_files()) {
        if (leads_out(name)) refuse(session, name, "may be a different file on another machine");
        if (is_odd(name)) refuse(session, name, "has blanks at the ends of its name, or control characters");
        bundle.files.push_back({name, read_file(session, name)});
    }
    return bundle;
}

std::string to_stream(const SessionBundle& bundle) {
    std::string stream;
    for (const BundledFile& file : bundle.files)
        stream += fmt::format("{} {}\n", file.text.size(), file.name) + file.text;
    return stream + "end\n";
}

}  // namespace thimble
