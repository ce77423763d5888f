#include "study/ranks/ranks.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <fcntl.h>
#include <memory>
#include <system_error>
#include <unistd.h>

#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "session/settings/session_files.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

int number_in(const char* variable, int otherwise) {
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::atoi(text) : otherwise;
}

std::unique_ptr<Ranks>& joined() {
    static std::unique_ptr<Ranks> ranks;
    return ranks;
}

std::unique_ptr<Ranks> load_ranks() {
    const fs::path module = program_folder().parent_path() / "lib" / "thimble" / "thimble-ranks.so";
    // Open MPI loads parts of its own, which need its names.
    void* const loaded = dlopen(module.c_str(), RTLD_NOW | RTLD_GLOBAL);
    using Make = Ranks* (*)();
    const auto make =
        loaded != nullptr ? reinterpret_cast<Make>(dlsym(loaded, "make_thimble_ranks")) : nullptr;
    if (make == nullptr)
        throw Error(
            ExitCode::kUsage,
            "mpirun has started {} of this, and {} cannot be loaded ({}): build with -DTHIMBLE_MPI=ON, "
            "or leave mpirun out (one program uses all cores of its machine)",
            rank_count(), module.string(), dlerror());
    return std::unique_ptr<Ranks>(make());
}

// The folder of a rank that is not the first: the files of `out` as they were, so that it decides as rank 0 does.
class CopiedFolder {
  public:
    explicit CopiedFolder(const fs::path& out) {
        std::string pattern = (fs::temp_directory_path() / "thimble-rank-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr)
            throw Error(ExitCode::kRunFailed, "{}: cannot be made", pattern);
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
    dup2(nowhere, STDERR_FILENO);
    draw_nothing();
}

fs::path join_ranks(const fs::path& out) {
    if (rank_count() < 2) return out;
    joined() = load_ranks();
    if (own_rank() == 0) {
        joined()->meet();
        return out;
    }
    static const CopiedFolder copy(out);
    joined()->meet();
    return copy.path();
}

Ranks* joined_ranks() { return joined().get(); }

}  // namespace thimble
