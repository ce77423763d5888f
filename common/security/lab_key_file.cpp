#include "common/security/lab_key_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr std::string_view kWord = "thimble-lab-key-1 ";
constexpr std::size_t kBase64Bytes = sodium_base64_ENCODED_LEN(kKeyBytes, sodium_base64_VARIANT_ORIGINAL);
constexpr std::size_t kLineBytes = kWord.size() + kBase64Bytes;  // with the newline where base64's 0 would be
using Line = std::array<char, kLineBytes + 1>;

// How messages name a key, and how its owner gets another one.
struct KeyKind {
    const char *name, *anew;
};
constexpr KeyKind kLab{"lab key", "make one with 'thimble keygen', and copy it to each machine"},
    kUser{"user key", "remove it, and the next program makes a new one"};

std::filesystem::path home(const char* remedy) {
    const std::string folder = environment_text("HOME");
    if (folder.empty()) throw Error(ExitCode::kUsage, "HOME names no folder for the key: {}", remedy);
    return folder;
}

constexpr const char
    *kNameAFile = "name a file in [security] key_file",
    *kStateRemedy =
        "set XDG_STATE_HOME to a folder that you can write; a service needs [security] mode = "
        "\"lab-key\" (docs/security.md)";

// Of the XDG base directories. The standard: a relative one is to be ignored.
std::filesystem::path own_folder(const char* variable, const char* below_home, const char* remedy) {
    const std::string folder = environment_text(variable);
    const bool usable = !folder.empty() && folder.front() == '/';
    return (usable ? std::filesystem::path(folder) : home(remedy) / below_home) / "thimble";
}

void wipe(Line& line) { sodium_memzero(line.data(), line.size()); }

// systemd makes the file readable for this service alone: it is root's, with an access list that counts as a group.
bool is_credential(const std::filesystem::path& path, const struct stat& found) {
    const std::string folder = environment_text("CREDENTIALS_DIRECTORY");
    const bool readable_only = (found.st_mode & 07777U) == 0440 || (found.st_mode & 07777U) == 0400;
    return !folder.empty() && path.parent_path() == folder && found.st_uid == 0 && readable_only;
}

void check_owner_alone(const std::filesystem::path& path, const struct stat& found, const KeyKind& kind) {
    if (!S_ISREG(found.st_mode))
        throw Error(ExitCode::kUsage, "the {} '{}' is not a file", kind.name, path.string());
    if (is_credential(path, found)) return;
    if (found.st_uid != geteuid()) {
        throw Error(ExitCode::kUsage,
                    "the {} '{}' belongs to another user: copy it to a file of your own, or chown it",
                    kind.name, path.string());
    }
    if ((found.st_mode & 07777U) == 0600 || (found.st_mode & 07777U) == 0400) return;
    throw Error(
        ExitCode::kUsage,
        "other users may read or change the {2} '{0}' (mode {1:04o}): chmod 600 '{0}'; if they did: {3}",
        path.string(), found.st_mode & 07777U, kind.name, kind.anew);
}

std::optional<LabKey> parse_line(const Line& line, std::size_t size) {
    if (size != kLineBytes || std::string_view(line.data(), kWord.size()) != kWord ||
        line[kLineBytes - 1] != '\n')
        return std::nullopt;
    SecretKey key;
    std::size_t length = 0;
    if (sodium_base642bin(key.bytes.data(), key.bytes.size(), line.data() + kWord.size(), kBase64Bytes - 1,
                          nullptr, &length, nullptr, sodium_base64_VARIANT_ORIGINAL) != 0 ||
        length != kKeyBytes)
        return std::nullopt;
    return LabKey(key.bytes);
}

bool write_line(int file, const RandomBytes& random) {
    SecretKey key;
    random(key.bytes);
    Line line{};
    std::memcpy(line.data(), kWord.data(), kWord.size());
    sodium_bin2base64(line.data() + kWord.size(), kBase64Bytes, key.bytes.data(), key.bytes.size(),
                      sodium_base64_VARIANT_ORIGINAL);
    line[kLineBytes - 1] = '\n';
    const bool written =
        write(file, line.data(), kLineBytes) == static_cast<ssize_t>(kLineBytes) && fsync(file) == 0;
    wipe(line);
    return written;
}

// The file gets its name when it is complete, so of two programs that make it at once both read one key. Returns errno; 0: made.
int make_key_file(const std::filesystem::path& path, const RandomBytes& random) {
    std::string draft = path.string() + ".XXXXXX";
    const FileDescriptor file(mkostemp(draft.data(), O_CLOEXEC));
    if (file.get() < 0) return errno;
    fchmod(file.get(), 0600);  // whatever the umask says
    errno = ENOSPC;            // of a line that was written in part
    const bool named = write_line(file.get(), random) && link(draft.c_str(), path.c_str()) == 0;
    const int error = named ? 0 : errno;
    unlink(draft.c_str());
    return error;
}

LabKey read_key(const std::filesystem::path& path, const KeyKind& kind) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat found {};
    if (file.get() < 0 || fstat(file.get(), &found) != 0) {
        throw Error(ExitCode::kUsage, "cannot read the {} '{}': {}; {} (docs/security.md)", kind.name,
                    path.string(), std::strerror(errno), kind.anew);
    }
    check_owner_alone(path, found, kind);
    Line line{};
    const auto size = read(file.get(), line.data(), line.size());
    auto key = parse_line(line, size < 0 ? 0 : static_cast<std::size_t>(size));
    wipe(line);
    if (!key) {
        throw Error(ExitCode::kData,
                    "'{}' holds no {}: it must have one line '{}BASE64', as thimble keygen writes it; {}",
                    path.string(), kind.name, kWord, kind.anew);
    }
    return std::move(*key);
}

}  // namespace

std::filesystem::path default_lab_key_file() {
    return own_folder("XDG_CONFIG_HOME", ".config", kNameAFile) / "lab.key";
}

std::filesystem::path lab_key_file(std::string_view setting) {
    if (const std::string given = environment_text("CREDENTIALS_DIRECTORY"); !given.empty()) {
        auto credential = std::filesystem::path(given) / "lab.key";
        if (access(credential.c_str(), F_OK) == 0) return credential;
    }
    return new_lab_key_file(setting);
}

std::filesystem::path new_lab_key_file(std::string_view setting) {
    if (setting.starts_with("~/")) return home(kNameAFile) / setting.substr(2);
    if (!setting.empty()) return setting;
    const std::string named = environment_text("THIMBLE_LAB_KEY_FILE");
    return named.empty() ? default_lab_key_file() : std::filesystem::path(named);
}

void create_lab_key(const std::filesystem::path& path, const RandomBytes& random) {
    refuse_folder(path);
    make_folder(path.parent_path());
    const int error = make_key_file(path, random);
    if (error == EEXIST)
        throw Error(ExitCode::kUsage,
                    "'{}' exists, and a key is never overwritten: name another file, or move this one",
                    path.string());
    if (error != 0) throw Error(ExitCode::kData, "cannot make '{}': {}", path.string(), std::strerror(error));
}

LabKey read_lab_key(const std::filesystem::path& path) { return read_key(path, kLab); }

std::filesystem::path user_key_file() {
    return own_folder("XDG_STATE_HOME", ".local/state", kStateRemedy) / "user.key";
}

bool has_user_key() { return access(user_key_file().c_str(), F_OK) == 0; }

LabKey own_user_key(const RandomBytes& random) {
    const std::filesystem::path path = user_key_file();
    if (has_user_key()) return read_key(path, kUser);
    std::error_code folder;
    std::filesystem::create_directories(path.parent_path(), folder);
    const int error = folder ? folder.value() : make_key_file(path, random);
    if (error == 0 || error == EEXIST) return read_key(path, kUser);
    throw Error(ExitCode::kUsage, "cannot make the user key '{}': {}; {}", path.string(),
                std::strerror(error), kStateRemedy);
}

}  // namespace thimble
