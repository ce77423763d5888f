#include "master/devices/vendor_library.hpp"

#include <algorithm>
#include <cstring>
#include <dlfcn.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

// The missing link of a library whose fully named file is there: the maker ships no link.
std::string missing_link(const fs::path& file) {
    std::error_code ignored;
    if (!file.has_parent_path() || fs::exists(file, ignored)) return "";
    const std::string name = file.filename().string();
    for (const fs::path& beside : library_files_in(file.parent_path(), {name})) {
        return fmt::format(" The link is missing: run `sudo ln -s {} {}`, or name {} itself.",
                           beside.filename().string(), file.string(), beside.filename().string());
    }
    return "";
}

std::string dl_words() {
    const char* words = dlerror();  // NOLINT(concurrency-mt-unsafe): before any thread
    return words == nullptr ? "no reason is known" : words;
}

}  // namespace

std::vector<fs::path> library_files_in(const fs::path& folder,
                                       std::initializer_list<std::string_view> beginnings) {
    std::vector<fs::path> files;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(folder, absent)) {
        const std::string name = entry.path().filename().string();
        const auto begins = [&](std::string_view beginning) { return name.rfind(beginning, 0) == 0; };
        if (std::any_of(beginnings.begin(), beginnings.end(), begins)) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return strverscmp(a.filename().c_str(), b.filename().c_str()) > 0;
    });
    return files;
}

void LibraryPlaces::add_folder(const fs::path& folder, const std::vector<fs::path>& found,
                               std::string_view none) {
    for (const fs::path& file : found) files.push_back(file.string());
    if (found.empty()) in_vain.push_back(fmt::format("{}: {}", folder.string(), none));
}

VendorLibrary::VendorLibrary(const std::string& file, LibraryPlaces (*usual)(), const VendorTexts& words)
    : words_(words) {
    auto [files, in_vain] = file.empty() ? usual() : LibraryPlaces{{file}, {}};
    in_vain.reserve(in_vain.size() + files.size());
    for (const std::string& candidate : files) {
        handle_ = dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (handle_ != nullptr) {
            file_ = candidate;
            return;
        }
        in_vain.push_back(dl_words() + missing_link(candidate));
    }
    throw Error(ExitCode::kUsage, "no library for {}:\n  {}\n{}", words_.handle, fmt::join(in_vain, "\n  "),
                words_.source);
}

VendorLibrary::~VendorLibrary() {
    if (handle_ != nullptr) dlclose(handle_);
}

VendorLibrary::VendorLibrary(VendorLibrary&& other) noexcept
    : words_(other.words_), handle_(std::exchange(other.handle_, nullptr)), file_(std::move(other.file_)) {}

void* VendorLibrary::symbol(const char* name) const { return dlsym(handle_, name); }

void VendorLibrary::refuse(const char* name) const {
    throw Error(ExitCode::kUsage, "{} has no function {}: {}. {}", file_, name, words_.alien, words_.source);
}

}  // namespace thimble
