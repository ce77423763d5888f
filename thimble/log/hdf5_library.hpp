// The HDF5 library (1.10 or later) as it is found when it is needed, with the few calls that Thimble makes; their words are in
// its reference manual (https://docs.hdfgroup.org). Opened at run time: only `thimble log export --hdf5` uses it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace thimble {

class Hdf5Library {
  public:
    using Id = std::int64_t;  // hid_t
    using Size = unsigned long long;

    // Throws Error (run failed), with what to install, if there is none.
    Hdf5Library();
    ~Hdf5Library() = default;  // the library tidies up when the program ends, and must be there then
    Hdf5Library(const Hdf5Library&) = delete;
    Hdf5Library& operator=(const Hdf5Library&) = delete;

    Id (*create_file)(const char*, unsigned, Id, Id) = nullptr;
    int (*close_file)(Id) = nullptr;
    Id (*create_properties)(Id) = nullptr;
    int (*create_groups_on_the_way)(Id, unsigned) = nullptr;
    Id (*create_space)(int, const Size*, const Size*) = nullptr;
    Id (*create_scalar)(int) = nullptr;
    int (*close_space)(Id) = nullptr;
    Id (*create_dataset)(Id, const char*, Id, Id, Id, Id, Id) = nullptr;
    int (*write_dataset)(Id, Id, Id, Id, Id, const void*) = nullptr;
    int (*close_dataset)(Id) = nullptr;
    Id (*create_attribute)(Id, const char*, Id, Id, Id, Id) = nullptr;
    int (*write_attribute)(Id, Id, const void*) = nullptr;
    int (*close_attribute)(Id) = nullptr;
    Id (*copy_type)(Id) = nullptr;
    int (*set_size)(Id, std::size_t) = nullptr;
    Id link_creation = -1, native_double = -1, native_int64 = -1, native_uint64 = -1, text = -1;

  private:
    void* symbol(const char* name) const;
    template <class Function>
    void find(Function*& function, const char* name) const {
        function = reinterpret_cast<Function*>(symbol(name));  // as dlsym(3) wants it
    }
    Id constant(const char* name) const { return *static_cast<const Id*>(symbol(name)); }

    void* library_ = nullptr;
};

}  // namespace thimble
