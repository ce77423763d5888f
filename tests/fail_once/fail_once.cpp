// A library to load before others (LD_PRELOAD): the n-th call of one kind fails, in one program. Calls count from the begin of main().
//
//   FAIL_ONCE_PROGRAM  the program's name, as in /proc/self/comm
//   FAIL_ONCE_KIND     one of kKinds
//   FAIL_ONCE_AT       which call fails, from 1; 0: none
//   FAIL_ONCE_COUNTS   a file that gets "kind count" lines at the program's end
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
}

namespace {

struct Kind {
    const char* name;
    int error;
};
enum { kAlloc, kOpen, kRead, kWrite, kFsync, kSocket, kSend, kReceive, kRename, kKinds };
constexpr std::array<Kind, kKinds> kNames{{{"alloc", ENOMEM},
                                           {"open", EMFILE},
                                           {"read", EIO},
                                           {"write", ENOSPC},
                                           {"fsync", EIO},
                                           {"socket", EMFILE},
                                           {"send", ENOBUFS},
                                           {"receive", ENOMEM},
                                           {"rename", EIO}}};

std::array<std::atomic<unsigned long>, kKinds> counts;
std::atomic<bool> armed{false};
int failing_kind = -1;
unsigned long failing_call = 0;
int (*real_main)(int, char**, char**) = nullptr;

template <class Function>
Function* next_of(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Whether this call fails; errno says why.
bool fails(int kind) {
    if (!armed.load(std::memory_order_relaxed)) return false;
    const unsigned long call = 1 + counts[static_cast<size_t>(kind)].fetch_add(1, std::memory_order_relaxed);
    if (kind != failing_kind || call != failing_call) return false;
    errno = kNames[static_cast<size_t>(kind)].error;
    return true;
}

void write_counts() {
    armed = false;
    const char* path = std::getenv("FAIL_ONCE_COUNTS");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    if (file == nullptr) return;
    for (size_t i = 0; i < kKinds; ++i) std::fprintf(file, "%s %lu\n", kNames[i].name, counts[i].load());
    std::fclose(file);
}

int counting_main(int argc, char** argv, char** environment) {
    const char* program = std::getenv("FAIL_ONCE_PROGRAM");
    const char* kind = std::getenv("FAIL_ONCE_KIND");
    const char* at = std::getenv("FAIL_ONCE_AT");
    if (program == nullptr || std::strcmp(program, program_invocation_short_name) != 0)
        return real_main(argc, argv, environment);
    for (size_t i = 0; i < kKinds && kind != nullptr; ++i)
        if (std::strcmp(kind, kNames[i].name) == 0) failing_kind = static_cast<int>(i);
    if (at != nullptr) failing_call = std::strtoul(at, nullptr, 10);
    std::atexit(write_counts);
    armed = true;
    const int code = real_main(argc, argv, environment);
    armed = false;
    return code;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
    real_main = main;
    static auto* const next =
        next_of<int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*)>(
            "__libc_start_main");
    return next(counting_main, argc, argv, init, fini, rtld_fini, stack_end);
}

void* malloc(size_t size) { return fails(kAlloc) ? nullptr : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return fails(kAlloc) ? nullptr : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return fails(kAlloc) ? nullptr : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) {
    return fails(kAlloc) ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void** place, size_t alignment, size_t size) {
    void* const memory = memalign(alignment, size);
    if (memory == nullptr) return ENOMEM;
    *place = memory;
    return 0;
}

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = va_arg(rest, mode_t);
    va_end(rest);
    static auto* const next = next_of<int(const char*, int, ...)>("open");
    return fails(kOpen) ? -1 : next(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = va_arg(rest, mode_t);
    va_end(rest);
    return open(path, flags, mode);
}
std::FILE* fopen(const char* path, const char* mode) {
    static auto* const next = next_of<std::FILE*(const char*, const char*)>("fopen");
    return fails(kOpen) ? nullptr : next(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }
int rename(const char* from, const char* to) {
    static auto* const next = next_of<int(const char*, const char*)>("rename");
    return fails(kRename) ? -1 : next(from, to);
}

ssize_t read(int file, void* bytes, size_t size) {
    static auto* const next = next_of<ssize_t(int, void*, size_t)>("read");
    return fails(kRead) ? -1 : next(file, bytes, size);
}
ssize_t write(int file, const void* bytes, size_t size) {
    static auto* const next = next_of<ssize_t(int, const void*, size_t)>("write");
    return fails(kWrite) ? -1 : next(file, bytes, size);
}
ssize_t writev(int file, const iovec* parts, int count) {
    static auto* const next = next_of<ssize_t(int, const iovec*, int)>("writev");
    return fails(kWrite) ? -1 : next(file, parts, count);
}
size_t fwrite(const void* bytes, size_t size, size_t count, std::FILE* file) {
    static auto* const next = next_of<size_t(const void*, size_t, size_t, std::FILE*)>("fwrite");
    return fails(kWrite) ? 0 : next(bytes, size, count, file);
}
int fsync(int file) {
    static auto* const next = next_of<int(int)>("fsync");
    return fails(kFsync) ? -1 : next(file);
}
int fdatasync(int file) {
    static auto* const next = next_of<int(int)>("fdatasync");
    return fails(kFsync) ? -1 : next(file);
}

int socket(int domain, int type, int protocol) {
    static auto* const next = next_of<int(int, int, int)>("socket");
    return fails(kSocket) ? -1 : next(domain, type, protocol);
}
ssize_t send(int socket, const void* bytes, size_t size, int flags) {
    static auto* const next = next_of<ssize_t(int, const void*, size_t, int)>("send");
    return fails(kSend) ? -1 : next(socket, bytes, size, flags);
}
ssize_t sendto(int socket, const void* bytes, size_t size, int flags, const sockaddr* to, socklen_t length) {
    static auto* const next =
        next_of<ssize_t(int, const void*, size_t, int, const sockaddr*, socklen_t)>("sendto");
    return fails(kSend) ? -1 : next(socket, bytes, size, flags, to, length);
}
ssize_t sendmsg(int socket, const msghdr* message, int flags) {
    static auto* const next = next_of<ssize_t(int, const msghdr*, int)>("sendmsg");
    return fails(kSend) ? -1 : next(socket, message, flags);
}
ssize_t recv(int socket, void* bytes, size_t size, int flags) {
    static auto* const next = next_of<ssize_t(int, void*, size_t, int)>("recv");
    return fails(kReceive) ? -1 : next(socket, bytes, size, flags);
}
ssize_t recvmsg(int socket, msghdr* message, int flags) {
    static auto* const next = next_of<ssize_t(int, msghdr*, int)>("recvmsg");
    return fails(kReceive) ? -1 : next(socket, message, flags);
}
int recvmmsg(int socket, mmsghdr* messages, unsigned count, int flags, timespec* limit) {
    static auto* const next = next_of<int(int, mmsghdr*, unsigned, int, timespec*)>("recvmmsg");
    return fails(kReceive) ? -1 : next(socket, messages, count, flags, limit);
}
int sendmmsg(int socket, mmsghdr* messages, unsigned count, int flags) {
    static auto* const next = next_of<int(int, mmsghdr*, unsigned, int)>("sendmmsg");
    return fails(kSend) ? -1 : next(socket, messages, count, flags);
}

}  // extern "C"
