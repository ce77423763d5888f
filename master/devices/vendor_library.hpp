// A maker's library, opened while the program runs: nothing of the maker is needed to build this, and nothing of it is here.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace thimble {

// Texts of the error messages.
struct VendorTexts {
    const char* handle;  // "the Force Dimension handle"
    const char* alien;   // "it is no Force Dimension library, or older than SDK 3.6"
    const char* source;  // where a user gets it
};

// Files in the order in which they are tried, and places without one.
struct LibraryPlaces {
    std::vector<std::string> files, in_vain;

    // The files that were found in a folder; `none` says which were sought.
    void add_folder(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& found,
                    std::string_view none);
};

class VendorLibrary {
  public:
    // `file`, or where that is empty the first of the usual places that opens. Throws Error (usage), which names each place and its reason.
    VendorLibrary(const std::string& file, LibraryPlaces (*usual)(), const VendorTexts& words);
    ~VendorLibrary();
    VendorLibrary(VendorLibrary&& other) noexcept;
    VendorLibrary& operator=(VendorLibrary&&) = delete;

    const std::string& file() const { return file_; }

    // Null if the library has no such function.
    template <class Function>
    void bind(const char* name, Function& function) const {
        function = reinterpret_cast<Function>(symbol(name));
    }
    // Throws Error (usage) instead.
    template <class Function>
    void need(const char* name, Function& function) const {
        bind(name, function);
        if (function == nullptr) refuse(name);
    }

  private:
    void* symbol(const char* name) const;
    [[noreturn]] void refuse(const char* name) const;

    VendorTexts words_;
    void* handle_ = nullptr;
    std::string file_;
};

// Files of a folder whose names begin with one of these, the newest version first ("3.17" before "3.9"), later names first.
std::vector<std::filesystem::path> library_files_in(const std::filesystem::path& folder,
                                                    std::initializer_list<std::string_view> beginnings);

}  // namespace thimble
