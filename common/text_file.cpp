#include "common/text_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sodium.h>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace thimble {
namespace {

// True for streams of the system and links to them.
bool is_of_the_system(const std::filesystem::path& file) {
    const std::string folder = file.parent_path().string();
    return folder == "/dev" || folder.starts_with("/dev/fd") || folder.starts_with("/proc/");
}

const char* advice_on(int error) {
    switch (error) {
        case EROFS:
            return "; name a folder on a writable disk";
        case EMFILE:
        case ENFILE:
            return descriptor_advice(error);
        case ENOSPC:
        case EDQUOT:
            return "; free space on that disk";
        default:
            return "; check directory and permissions";
    }
}

}  // namespace

int open_to_write(const std::filesystem::path& file, int flags) {
    const int link = is_of_the_system(file) ? 0 : O_NOFOLLOW;
    return ::open(file.c_str(), flags | O_WRONLY | O_CREAT | O_CLOEXEC | link, 0666);
}

const char* descriptor_advice(int error) {
    return error == EMFILE || error == ENFILE ? "; raise 'ulimit -n'" : "";
}

void fail_to_create(const std::filesystem::path& file, int error, ExitCode otherwise) {
    if (error == ELOOP) {
        throw Error(
            ExitCode::kUsage,
            "{}: is a symbolic link, which is never written through: remove it, or name another folder",
            file.string());
    }
    const bool no_room = error == EMFILE || error == ENFILE || error == ENOSPC || error == EDQUOT;
    throw Error(no_room ? ExitCode::kRunFailed : otherwise, "{}: cannot be created: {}{}", file.string(),
                std::strerror(error), advice_on(error));
}

bool write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = ::write(descriptor, text.data(), text.size());
        if (n < 0 && errno != EINTR) return false;
        text.remove_prefix(n < 0 ? 0 : static_cast<std::size_t>(n));
    }
    return true;
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    refuse_folder(path);
    const int descriptor = open_to_write(path, O_TRUNC);
    if (descriptor < 0) fail_to_create(path, errno, ExitCode::kRunFailed);
    const bool written = write_all(descriptor, text);
    const int error = errno;
    if (::close(descriptor) == 0 && written) return;  // a full disk shows here at the latest
    throw Error(ExitCode::kRunFailed, "{}: cannot be written: {}; check the disk's free space", path.string(),
                std::strerror(written ? errno : error));
}

void remove_file(const std::filesystem::path& file) {
    std::error_code failure;
    std::filesystem::remove(file, failure);
    if (!failure) return;
    throw Error(ExitCode::kUsage, "{}: cannot be removed: {}{}", file.string(), failure.message(),
                advice_on(failure.value()));
}

void refuse_half_read(const std::istream& stream, const std::filesystem::path& file) {
    if (stream.bad())
        throw Error(
            ExitCode::kData,
            "{}: cannot be read to its end: its disk or network failed; try again, or restore the file",
            file.string());
}

std::string read_to_end(std::istream& stream, const std::filesystem::path& file, std::size_t most) {
    std::string text;
    std::string block(std::size_t{1} << 16U, '\0');
    while (text.size() <= most &&
           (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0))
        text.append(block, 0, std::min(static_cast<std::size_t>(stream.gcount()), most + 1 - text.size()));
    refuse_half_read(stream, file);
    return text;
}

std::string read_text_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return read_to_end(file, path);
}

std::string first_line(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

std::string read_whole_file(const std::filesystem::path& path, std::size_t most) {
    refuse_folder(path, ExitCode::kData);
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw Error(ExitCode::kData,
                    "{}: cannot be read; check that the file exists and that you may read it", path.string());
    }
    // Reads to the end instead of by size: a pipe has none.
    std::string text = read_to_end(file, path, most);
    if (text.size() <= most) return text;
    throw Error(ExitCode::kData, "{}: is larger than {} bytes, the limit", path.string(), most);
}

std::string sha256_of_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    crypto_hash_sha256_state state;
    crypto_hash_sha256_init(&state);
    std::array<char, 65536> part{};
    while (file.read(part.data(), part.size()), file.gcount() > 0) {
        crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(part.data()),
                                  static_cast<unsigned long long>(file.gcount()));
    }
    refuse_half_read(file, path);
    std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
    crypto_hash_sha256_final(&state, digest.data());
    return fmt::format("{:02x}", fmt::join(digest, ""));
}

void refuse_folder(const std::filesystem::path& file, ExitCode code) {
    std::error_code unknown;
    if (!std::filesystem::is_directory(file, unknown)) return;
    throw Error(code, "{}: is a folder; name a file", file.string());
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code failure;
    if (!folder.empty()) std::filesystem::create_directories(folder, failure);
    std::error_code unknown;
    for (auto part = folder; failure && part.has_relative_path(); part = part.parent_path()) {
        if (!std::filesystem::exists(part, unknown)) continue;
        if (std::filesystem::is_directory(part, unknown)) break;
        throw Error(ExitCode::kUsage, "{}: is a file; name a folder", part.string());
    }
    if (failure) {
        throw Error(ExitCode::kUsage,
                    "{}: cannot be made: {}; name another folder, or change its permissions", folder.string(),
                    failure.message());
    }
}

std::vector<std::string_view> words_of(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    std::vector<std::string_view> words;
    for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
        const std::size_t end = text.find_first_of(kBlanks, at);
        words.push_back(text.substr(at, end - at));
        at = text.find_first_not_of(kBlanks, end);
    }
    return words;
}

void split_at(char separator, std::string_view text, std::vector<std::string_view>& parts) {
    parts.clear();
    for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
        parts.push_back(text.substr(0, end));
        text.remove_prefix(end + 1);
    }
    parts.push_back(text);
}

}  // namespace thimble
