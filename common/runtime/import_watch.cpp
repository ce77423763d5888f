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

// The function F of the C library, counted.
template <auto Which, auto F>
struct Watched;
template <auto Which, class R, class... A, bool N, R (*F)(A...) noexcept(N)>
struct Watched<Which, F> {
    static R call(A... a) {
        count(Which);
        return F(a...);
    }
};

// Both stand for functions that take any number of arguments.
int open_with_mode(const char* name, int how, unsigned mode) { return open(name, how, mode); }
int openat_with_mode(int folder, const char* name, int how, unsigned mode) {
    return openat(folder, name, how, mode);
}

struct Replacement {
    std::string_view name;
    void* function;
};
template <auto Which, auto F>
Replacement by(std::string_view name) {
    return {name, reinterpret_cast<void*>(Watched<Which, F>::call)};
}

const std::array<Replacement, 23>& replacements() {
    static const std::array kAll{by<&ImportCounts::allocations, std::malloc>("malloc"),
                                 by<&ImportCounts::allocations, std::calloc>("calloc"),
                                 by<&ImportCounts::allocations, std::realloc>("realloc"),
                                 by<&ImportCounts::allocations, posix_memalign>("posix_memalign"),
                                 by<&ImportCounts::allocations, std::aligned_alloc>("aligned_alloc"),
                                 by<&ImportCounts::allocations, memalign>("memalign"),
                                 by<&ImportCounts::allocations, mmap>("mmap"),
                                 by<&ImportCounts::allocations, mmap>("mmap64"),
                                 by<&ImportCounts::allocations, std::free>("free"),
                                 by<&ImportCounts::clocks, clock_gettime>("clock_gettime"),
                                 by<&ImportCounts::clocks, gettimeofday>("gettimeofday"),
                                 by<&ImportCounts::clocks, std::time>("time"),
                                 by<&ImportCounts::clocks, std::clock>("clock"),
                                 by<&ImportCounts::files, std::fopen>("fopen"),
                                 by<&ImportCounts::files, std::fopen>("fopen64"),
                                 by<&ImportCounts::files, std::fread>("fread"),
                                 by<&ImportCounts::files, open_with_mode>("open"),
                                 by<&ImportCounts::files, open_with_mode>("open64"),
                                 by<&ImportCounts::files, openat_with_mode>("openat"),
                                 by<&ImportCounts::files, openat_with_mode>("openat64"),
                                 by<&ImportCounts::files, getrandom>("getrandom"),
                                 by<&ImportCounts::files, read>("read"),
                                 by<&ImportCounts::files, write>("write")};
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
