// thimble-sweep-mpi: thimble sweep with the ranks of an MPI job for its workers. The same options, the same bytes.
#include <string>

#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <CLI/CLI.hpp>

#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/version.hpp"
#include "study/maps/map_options.hpp"
#include "study/maps/mpi/rank_pool.hpp"

namespace {

using namespace thimble;

// Rank 0 reads first, the others after it, so that a mistake is reported once.
int run_rank(int argc, char** argv, int rank, bool& together) {
    CLI::App app(
        "thimble sweep for mpirun: the ranks work out the cells of a map. thimble sweep under mpirun is "
        "this.",
        "thimble-sweep-mpi");
    app.set_version_flag("--version", std::string(kVersion));
    SweepArguments arguments;
    add_sweep_options(app, arguments);
    int good = 1;
    if (rank > 0) MPI_Bcast(&good, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (good == 0) return 0;
    const auto tell = [&](int verdict) { MPI_Bcast(&verdict, 1, MPI_INT, 0, MPI_COMM_WORLD); };
    if (const auto exit_code = parse_command_line(app, argc, argv)) {
        if (rank == 0) tell(0);
        return *exit_code;
    }
    MapGrid grid;
    try {
        grid = grid_of(arguments);
    } catch (...) {
        if (rank == 0) tell(0);
        throw;
    }
    if (rank == 0) tell(1);
    together = true;
    install_stop_signals();
    RankPool pool(arguments.jobs > 0 ? arguments.jobs : 1);
    if (pool.leads()) return run_map(arguments, grid, pool);
    CellWriter writer(grid);
    pool.serve([&writer](const CellRange& range) { return writer.rows(range); });
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    open_standard_descriptors();  // before MPI opens anything
    int threads = 0, rank = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &threads);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    bool together = false, failed = true;
    const int code = guarded_main("thimble-sweep-mpi", [&] {
        const int result = run_rank(argc, argv, rank, together);
        failed = false;
        return result;
    });
    // A rank that fails alone ends the others too. Before the work begins all end by themselves.
    if (failed && together) MPI_Abort(MPI_COMM_WORLD, code);
    MPI_Finalize();
    return code;
}
