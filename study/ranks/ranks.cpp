#include "study/ranks/ranks.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <memory>
#include <poll.h>
#include <sys/mman.h>
#include <system_error>
#include <unistd.h>

#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "common/own_program.hpp"

namespace thimble {
namespace {

constexpr int kOthersSpeak_ms = 2000;

namespace fs = std::filesystem;

int number_in(const char* variable, int otherwise) {
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::atoi(text) : otherwise;
}

std::unique_ptr<Ranks>& joined() {
    static std::unique_ptr<Ranks> ranks;
    return ranks;
}

int& own_stderr() {
    static int descriptor = STDERR_FILENO;
    return descriptor;
}

std::string host_name() {
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    return name.data();
}

// The last line that a rank but the first did not say.
std::string last_unsaid() {
    std::array<char, 2000> end{};
    const off_t size = lseek(STDERR_FILENO, 0, SEEK_END);
    const off_t from = std::max<off_t>(0, size - static_cast<off_t>(end.size()));
    const ssize_t read = pread(STDERR_FILENO, end.data(), end.size(), from);
    std::string text(end.data(), static_cast<std::size_t>(std::max<ssize_t>(0, read)));
    text.erase(text.find_last_not_of('\n') + 1);
    return text.substr(text.rfind('\n') + 1);
}

std::unique_ptr<Ranks> load_ranks() {
    const fs::path module = program_folder().parent_path() / "lib" / "thimble" / "thimble-ranks.so";
    // Open MPI loads parts of its own, which need its names.
    void* const loaded = dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
    using Make = Ranks* (*)();
    const auto make =
        loaded != nullptr ? reinterpret_cast<Make>(dlsym(loaded, "make_thimble_ranks")) : nullptr;
    if (make == nullptr)
        throw Error(ExitCode::kUsage,
                    "mpirun has started {} copies of this program, but {} cannot be loaded ({}): install "
                    "libopenmpi3, build with -DTHIMBLE_MPI=ON, or start without mpirun (one program uses all "
                    "cores of its machine)",
                    rank_count(), module.string(), dlerror());
    return std::unique_ptr<Ranks>(make());
}

// The folder of a rank that is not the first: the files of `out` as they were, so that it decides as rank 0 does.
class CopiedFolder {
  public:
    explicit CopiedFolder(const fs::path& out) {
        std::string pattern = (fs::temp_directory_path() / "thimble-rank-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr)
            throw Error(ExitCode::kRunFailed, "{}: cannot make this folder: check that the place is writable",
                        pattern);
        folder_ = pattern;
        if (fs::is_directory(out)) fs::copy(out, folder_);  // its files, no folders
    }
    ~CopiedFolder() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    CopiedFolder(const CopiedFolder&) = delete;
    CopiedFolder& operator=(const CopiedFolder&) = delete;
    const fs::path& path() const { return folder_; }

  private:
    fs::path folder_;
};

}  // namespace

int rank_count() { return number_in("OMPI_COMM_WORLD_SIZE", 1); }
int own_rank() { return number_in("OMPI_COMM_WORLD_RANK", 0); }

void quieten_other_ranks() {
    if (own_rank() == 0) return;
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nowhere, STDOUT_FILENO);
    own_stderr() = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    const int unsaid = memfd_create("unsaid", MFD_CLOEXEC);
    dup2(unsaid >= 0 ? unsaid : nowhere, STDERR_FILENO);
    draw_nothing();
}

int end_of_rank(int code) {
    if (own_rank() == 0) return code;
    if (code == 0) return 0;
    const std::string why = fmt::format("rank {} on {}: {}", own_rank(), host_name(), last_unsaid());
    // mpirun would end rank 0 before it has written all.
    if (Ranks* const ranks = joined_ranks()) {
        ranks->fail(why);
        return 0;
    }
    // Most errors occur in every rank. Rank 0 reports them, and mpirun ends this rank meanwhile.
    poll(nullptr, 0, kOthersSpeak_ms);
    dprintf(own_stderr(), "%s\n", why.c_str());
    return code;
}

fs::path join_ranks(const fs::path& out) {
    if (rank_count() < 2) return out;
    auto& ranks = joined();  // lives longer than the copy
    if (own_rank() == 0) {
        ranks = load_ranks();
        ranks->meet();
        return out;
    }
    // Before the ranks join: rank 0 does not yet wait for one that fails here.
    static const CopiedFolder copy(out);
    ranks = load_ranks();
    ranks->meet();
    return copy.path();
}

Ranks* joined_ranks() { return joined().get(); }

}  // namespace thimble
