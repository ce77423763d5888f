#include "common/runtime/import_watch.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <malloc.h>
#include <span>
#include <string_view>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/time.h>
#include <unistd.h>

namespace thimble {
namespace {

thread_local bool watching = false;
thread_local ImportCounts seen;

void count(std::uint64_t ImportCounts::*which) { seen.*which += watching ? 1 : 0; }

void* watched_malloc(std::size_t size) {
    count(&ImportCounts::allocations);
    return std::malloc(size);
}
void* watched_calloc(std::size_t number, std::size_t size) {
    count(&ImportCounts::allocations);
    return std::calloc(number, size);
}
void* watched_realloc(void* old, std::size_t size) {
    count(&ImportCounts::allocations);
    return std::realloc(old, size);
}
int watched_posix_memalign(void** where, std::size_t alignment, std::size_t size) {
    count(&ImportCounts::allocations);
    return posix_memalign(where, alignment, size);
}
void* watched_aligned_alloc(std::size_t alignment, std::size_t size) {
    count(&ImportCounts::allocations);
    return std::aligned_alloc(alignment, size);
}
void* watched_memalign(std::size_t alignment, std::size_t size) {
    count(&ImportCounts::allocations);
    return memalign(alignment, size);
}
void* watched_mmap(void* where, std::size_t size, int may, int how, int file, off_t offset) {
    count(&ImportCounts::allocations);
    return mmap(where, size, may, how, file, offset);
}
void watched_free(void* old) {
    count(&ImportCounts::allocations);
    std::free(old);
}
int watched_clock_gettime(clockid_t which, timespec* now) {
    count(&ImportCounts::clocks);
    return clock_gettime(which, now);
}
int watched_gettimeofday(timeval* now, void* zone) {
    count(&ImportCounts::clocks);
    return gettimeofday(now, zone);
}
std::time_t watched_time(std::time_t* now) {
    count(&ImportCounts::clocks);
    return std::time(now);
}
std::clock_t watched_clock() {
    count(&ImportCounts::clocks);
    return std::clock();
}
std::FILE* watched_fopen(const char* name, const char* mode) {
    count(&ImportCounts::files);
    return std::fopen(name, mode);
}
std::size_t watched_fread(void* to, std::size_t size, std::size_t most, std::FILE* from) {
    count(&ImportCounts::files);
    return std::fread(to, size, most, from);
}
int watched_open(const char* name, int how, unsigned mode) {
    count(&ImportCounts::files);
    return open(name, how, mode);
}
int watched_openat(int folder, const char* name, int how, unsigned mode) {
    count(&ImportCounts::files);
    return openat(folder, name, how, mode);
}
// From the system, as a file of random bytes is.
ssize_t watched_getrandom(void* to, std::size_t most, unsigned how) {
    count(&ImportCounts::files);
    return getrandom(to, most, how);
}
ssize_t watched_read(int from, void* to, std::size_t most) {
    count(&ImportCounts::files);
    return read(from, to, most);
}
ssize_t watched_write(int to, const void* from, std::size_t most) {
    count(&ImportCounts::files);
    return write(to, from, most);
}

struct Replacement {
    std::string_view name;
    void* function;
};
template <class Function>
Replacement by(std::string_view name, Function* function) {
    return {name, reinterpret_cast<void*>(function)};
}

const std::array<Replacement, 23>& replacements() {
    static const std::array kAll{by("malloc", watched_malloc),
                                 by("calloc", watched_calloc),
                                 by("realloc", watched_realloc),
                                 by("posix_memalign", watched_posix_memalign),
                                 by("aligned_alloc", watched_aligned_alloc),
                                 by("memalign", watched_memalign),
                                 by("mmap", watched_mmap),
                                 by("mmap64", watched_mmap),
                                 by("free", watched_free),
                                 by("clock_gettime", watched_clock_gettime),
                                 by("gettimeofday", watched_gettimeofday),
                                 by("time", watched_time),
                                 by("clock", watched_clock),
                                 by("fopen", watched_fopen),
                                 by("fopen64", watched_fopen),
                                 by("fread", watched_fread),
                                 by("open", watched_open),
                                 by("open64", watched_open),
                                 by("openat", watched_openat),
                                 by("openat64", watched_openat),
                                 by("getrandom", watched_getrandom),
                                 by("read", watched_read),
                                 by("write", watched_write)};
    return kAll;
}

// The tables that an object's dynamic section names. The linker has made their addresses absolute.
struct DynamicTables {
    const ElfW(Sym) * symbols = nullptr;
    const char* strings = nullptr;
    std::span<const ElfW(Rela)> relocations, jumps;
};

template <class To>
To* at(ElfW(Addr) address) {
    return reinterpret_cast<To*>(address);  // NOLINT(performance-no-int-to-ptr)
}

DynamicTables tables_of(const ElfW(Dyn) * entry) {
    DynamicTables tables;
    const ElfW(Rela)* relocations = nullptr, *jumps = nullptr;
    std::size_t relocation_bytes = 0, jump_bytes = 0;
    for (; entry->d_tag != DT_NULL; ++entry) {
        if (entry->d_tag == DT_SYMTAB) tables.symbols = at<const ElfW(Sym)>(entry->d_un.d_ptr);
        if (entry->d_tag == DT_STRTAB) tables.strings = at<const char>(entry->d_un.d_ptr);
        if (entry->d_tag == DT_RELA) relocations = at<const ElfW(Rela)>(entry->d_un.d_ptr);
        if (entry->d_tag == DT_RELASZ) relocation_bytes = entry->d_un.d_val;
        if (entry->d_tag == DT_JMPREL) jumps = at<const ElfW(Rela)>(entry->d_un.d_ptr);
        if (entry->d_tag == DT_PLTRELSZ) jump_bytes = entry->d_un.d_val;
    }
    if (relocations != nullptr) tables.relocations = {relocations, relocation_bytes / sizeof *relocations};
    if (jumps != nullptr) tables.jumps = {jumps, jump_bytes / sizeof *jumps};
    return tables;
}

#if defined(__x86_64__)
constexpr std::array<ElfW(Word), 3> kAddressTypes{R_X86_64_JUMP_SLOT, R_X86_64_GLOB_DAT, R_X86_64_64};
#elif defined(__aarch64__)
constexpr std::array<ElfW(Word), 3> kAddressTypes{R_AARCH64_JUMP_SLOT, R_AARCH64_GLOB_DAT, R_AARCH64_ABS64};
#else
constexpr std::array<ElfW(Word), 0> kAddressTypes{};
#endif

bool replace(void** slot, void* function) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    void* begin = at<void>(reinterpret_cast<ElfW(Addr)>(slot) & ~(page - 1));
    if (mprotect(begin, page, PROT_READ | PROT_WRITE) != 0) return false;
    *slot = function;
    return true;
}

bool watch(const DynamicTables& tables, std::span<const ElfW(Rela)> relocations, ElfW(Addr) base) {
    bool replaced = false;
    for (const ElfW(Rela) & one : relocations) {
        const auto type = static_cast<ElfW(Word)>(ELF64_R_TYPE(one.r_info));
        bool is_address = false;
        for (const ElfW(Word) known : kAddressTypes) is_address = is_address || known == type;
        if (!is_address) continue;
        const std::string_view name(tables.strings + tables.symbols[ELF64_R_SYM(one.r_info)].st_name);
        for (const Replacement& replacement : replacements()) {
            if (name == replacement.name)
                replaced = replace(at<void*>(base + one.r_offset), replacement.function) || replaced;
        }
    }
    return replaced;
}

// The C library calls itself without these addresses, and this program's own calls are the originals.
bool is_foreign(const char* name) {
    const std::string_view path(name);
    return !path.empty() && path.find("/libc.so") == std::string_view::npos &&
           path.find("/ld-linux") == std::string_view::npos && path.find("vdso") == std::string_view::npos;
}

}  // namespace

bool watch_imports() {
    bool replaced = false;
    dl_iterate_phdr(
        [](dl_phdr_info* object, std::size_t, void* any) {
            if (!is_foreign(object->dlpi_name)) return 0;
            for (const ElfW(Phdr) & part : std::span(object->dlpi_phdr, object->dlpi_phnum)) {
                if (part.p_type != PT_DYNAMIC) continue;
                const DynamicTables tables = tables_of(at<const ElfW(Dyn)>(object->dlpi_addr + part.p_vaddr));
                if (tables.symbols == nullptr || tables.strings == nullptr) continue;
                bool& found = *static_cast<bool*>(any);
                found = watch(tables, tables.relocations, object->dlpi_addr) || found;
                found = watch(tables, tables.jumps, object->dlpi_addr) || found;
            }
            return 0;
        },
        &replaced);
    return replaced;
}

ImportWatch::ImportWatch() { watching = true; }
ImportWatch::~ImportWatch() { watching = false; }
ImportCounts ImportWatch::counts() { return seen; }

}  // namespace thimble
