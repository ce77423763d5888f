#include "thimble/log/hdf5_library.hpp"

#include <array>
#include <cstdlib>
#include <dlfcn.h>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {

Hdf5Library::Hdf5Library() {
    const char* own = std::getenv("THIMBLE_HDF5_LIB");  // NOLINT(concurrency-mt-unsafe): before any thread
    for (const char* name : {own, "libhdf5_serial.so.103", "libhdf5_serial.so.310", "libhdf5.so.103",
                             "libhdf5.so.200", "libhdf5.so.310", "libhdf5.so"}) {
        if (library_ == nullptr && name != nullptr) library_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    }
    if (library_ == nullptr) {
        throw Error(ExitCode::kRunFailed,
                    "--hdf5 needs the HDF5 library: install it (Debian 12: sudo apt install "
                    "libhdf5-103-1), name it in THIMBLE_HDF5_LIB, or use --csv");
    }
    int (*open)() = nullptr;
    int (*version)(unsigned*, unsigned*, unsigned*) = nullptr;
    int (*be_quiet)(Id, void*, void*) = nullptr;
    find(open, "H5open");
    find(version, "H5get_libversion");
    find(be_quiet, "H5Eset_auto2");
    unsigned major = 0, minor = 0, release = 0;
    if (open() < 0 || version(&major, &minor, &release) < 0 || major != 1 || minor < 10) {
        throw Error(ExitCode::kRunFailed,
                    fmt::format("--hdf5 needs HDF5 1.10 or later, and not {}.{}: install it, or use --csv",
                                major, minor));
    }
    be_quiet(0, nullptr, nullptr);
    find(create_file, "H5Fcreate");
    find(close_file, "H5Fclose");
    find(create_properties, "H5Pcreate");
    find(create_groups_on_the_way, "H5Pset_create_intermediate_group");
    find(create_space, "H5Screate_simple");
    find(create_scalar, "H5Screate");
    find(close_space, "H5Sclose");
    find(create_dataset, "H5Dcreate2");
    find(write_dataset, "H5Dwrite");
    find(close_dataset, "H5Dclose");
    find(create_attribute, "H5Acreate2");
    find(write_attribute, "H5Awrite");
    find(close_attribute, "H5Aclose");
    find(copy_type, "H5Tcopy");
    find(set_size, "H5Tset_size");
    link_creation = constant("H5P_CLS_LINK_CREATE_ID_g");
    native_double = constant("H5T_NATIVE_DOUBLE_g");
    native_int64 = constant("H5T_NATIVE_INT64_g");
    native_uint64 = constant("H5T_NATIVE_UINT64_g");
    text = constant("H5T_C_S1_g");
}

void* Hdf5Library::symbol(const char* name) const {
    void* found = dlsym(library_, name);
    if (found != nullptr) return found;
    throw Error(ExitCode::kRunFailed,
                fmt::format("the HDF5 library that was found has no {}: use --csv", name));
}

}  // namespace thimble
