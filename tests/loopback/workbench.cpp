#include "tests/loopback/workbench.hpp"

#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "common/security/secret.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {

bool wait_until(const std::function<bool()>& condition, Duration limit) {
    const SessionTime deadline = wall_now() + limit;
    while (!condition()) {
        if (wall_now() > deadline) return condition();
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
    return true;
}

Folder::Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "thimble-loopback-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
}

Folder::~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path Folder::write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
}

std::vector<std::string> words_in(const std::string& line, const std::vector<std::string>& more) {
    std::istringstream stream(line);
    std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

namespace {

// A run would spend up to a second on figures, at which no test of real programs looks.
void hide_gnuplot(const std::filesystem::path& folder) {
    std::filesystem::create_directory(folder);
    replace_program(folder / "gnuplot", "exit 1");
    const char* others = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): before any thread
    const std::string path = fmt::format("{}:{}", folder.string(), others == nullptr ? "" : others);
    setenv("PATH", path.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): likewise
}

}  // namespace

// Stops that programs of this test leave behind belong to this test alone, not to an earlier block of the same ports. The user key
// is not the developer's.
PortBlock::PortBlock() {
    static const Folder kStops;
    static int blocks = 0;
    if (blocks == 0) hide_gnuplot(kStops / "bin");
    const std::filesystem::path stops = kStops / std::to_string(++blocks);
    std::filesystem::create_directory(stops);
    setenv("THIMBLE_STOP_DIR", stops.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): before any thread
    setenv("XDG_STATE_HOME", (kStops / "state").c_str(), 1);  // NOLINT(concurrency-mt-unsafe): likewise
}

NetworkSettings network_at(std::uint16_t base_port, const SecuritySettings& security) {
    NetworkSettings network;
    network.base_port = base_port;
    network.security = security;
    return network;
}

std::string under_lab_key(const std::filesystem::path& key) {
    if (!std::filesystem::exists(key)) create_lab_key(key, system_random_bytes());
    return "[security]\nmode = 'lab-key'\nkey_file = '" + key.string() + "'\n";
}

Typing::Typing() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
}

Typing::~Typing() {
    for (const int end : ends_) close(end);
}

void Typing::type(const std::string& lines) const {
    if (write(ends_[1], lines.data(), lines.size()) != static_cast<ssize_t>(lines.size()))
        throw std::runtime_error("nobody reads: " + lines);
}

SessionFile SessionFile::unhurried() { return endless(2); }

SessionFile SessionFile::endless(double contact_hold_s) {
    SessionFile session;
    session.contact_hold_s = contact_hold_s;
    return session;
}

std::string SessionFile::text() const {
    return fmt::format(
        "[session]\nmodalities = {}\n{}fixture_jitter_m = 0\nparallel_conditions = {}\n"
        "[fixture]\nposition_m = 0.035\n[trial]\ncontact_hold_s = {}\ntimeout_s = {}\n"
        "peer_wait_s = {}\n{}\n",
        modalities, delays_s.empty() ? "" : fmt::format("delays_s = {}\n", delays_s), parallel_conditions,
        contact_hold_s, 60 + contact_hold_s, peer_wait_s, more);
}

}  // namespace thimble
