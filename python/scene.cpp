// thimble.Scene: a needle in tissue, without a session.
#include <cmath>

#include "common/error.hpp"
#include "python/bindings.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

constexpr double kFarthest_m = 10;  // as SlaveNode has it

class PythonScene {
  public:
    PythonScene(const py::object& file, const std::string& solver, double longest_step_s)
        : scene_(declared(file), solver_maker(choice(solver, longest_step_s)), Transitions::kUnlimited) {
        reset(0);
    }

    void reset(double position_m) {
        check(position_m);
        scene_.reset({position_m, position_m});
        scene_.clear_transitions();
        events_.clear();
        time_s_ = 0;
    }

    double step(double duration_s, double position_m) {
        check(position_m);
        if (!(duration_s >= 0) || !std::isfinite(duration_s))
            throw Error(ExitCode::kUsage, "duration_s is {}, and must be 0 or more", duration_s);
        scene_.step(time_s_, duration_s, {position_m, position_m});
        for (const Transition& change : scene_.transitions())
            events_.emplace_back(time_s_ + change.offset_s, scene_.element_name(change.element),
                                 std::string(change.phase));
        scene_.clear_transitions();
        time_s_ += duration_s;
        return force_N();
    }

    py::dict follow(const Numbers& times_s, const Numbers& positions_m) {
        if (times_s.size() != positions_m.size() || times_s.size() == 0)
            throw Error(ExitCode::kUsage,
                        "time_s has {} values and position_m {}: they go in pairs, at least one",
                        times_s.size(), positions_m.size());
        std::vector<double> tissue_N, fixture_N, surface_m;
        const double start_s = times_s.data()[0];
        reset(positions_m.data()[0]);
        for (py::ssize_t i = 0; i < times_s.size(); ++i) {
            if (i % 4096 == 0) check_signals();
            step(i == 0 ? 0 : times_s.data()[i] - times_s.data()[i - 1], positions_m.data()[i]);
            time_s_ = times_s.data()[i] - start_s;  // without the rounding of a sum
            tissue_N.push_back(scene_.force_tissue_N());
            fixture_N.push_back(scene_.force_fixture_N());
            surface_m.push_back(surface());
        }
        py::dict forces;
        forces["force_tissue_N"] = to_array(tissue_N);
        forces["force_fixture_N"] = to_array(fixture_N);
        forces["position_surface_m"] = to_array(surface_m);
        return forces;
    }

    void place_fixture(double position_m, bool present) {
        check(position_m);
        if (scene_.fixture() == nullptr)
            throw Error(ExitCode::kUsage, "the scene has no forbidden region that could be placed");
        scene_.place_fixture(position_m, present);
    }

    double force_N() const { return force_tissue_N() + force_fixture_N(); }
    double force_tissue_N() const { return scene_.force_tissue_N(); }
    double force_fixture_N() const { return scene_.force_fixture_N(); }
    double time_s() const { return time_s_; }
    double surface() const {
        return scene_.surface() == nullptr ? std::nan("") : scene_.surface()->state().position_surface_m;
    }
    const std::vector<std::tuple<double, std::string, std::string>>& events() const { return events_; }

  private:
    static SceneDeclaration declared(const py::object& file) {
        if (py::isinstance<py::dict>(file)) {
            const ConfigFile config = ConfigFile::parse(toml_text(file), "the scene's dictionary");
            SceneDeclaration scene;
            config.read_all([&] { scene = read_scene(config, "dictionary"); });
            return scene;
        }
        return load_scene(py::str(file).cast<std::string>());
    }
    static SolverChoice choice(const std::string& solver, double longest_step_s) {
        for (const std::string_view name : kSolverNames) {
            if (name == solver && longest_step_s > 0) return {name, longest_step_s};
        }
        throw Error(ExitCode::kUsage,
                    "solver \"{}\", longest_step_s {}: the solver is one of {}, its step above 0", solver,
                    longest_step_s, fmt::join(kSolverNames, ", "));
    }
    static void check(double position_m) {
        if (!(std::abs(position_m) <= kFarthest_m))
            throw Error(ExitCode::kUsage, "position_m is {}, and must be within {} m", position_m,
                        kFarthest_m);
    }

    NeedleScene scene_;
    double time_s_ = 0;
    std::vector<std::tuple<double, std::string, std::string>> events_;
};

}  // namespace

void add_scene(py::module_& module) {
    using py::arg;
    py::class_<PythonScene>(module, "Scene",
                            R"(A needle in one dimension, and the tissue and fixtures that it meets.

file is the path of a scene file, the name of one that comes with Thimble ("paper.toml", "layers.toml", ...), or a dictionary of its
tables (docs/scenes.md). Positions are metres, positive into the tissue. Forces are newtons on the operator: negative resists insertion.

    scene = thimble.Scene("paper.toml")
    forces = scene.follow(time_s, position_m))")
        .def(py::init<const py::object&, const std::string&, double>(), arg("file") = "paper.toml",
             arg("solver") = "exact", arg("longest_step_s") = 1e-3)
        .def("reset", &PythonScene::reset, arg("position_m") = 0.0,
             "A new trial: tissue at rest, the needle at position_m, the clock at 0.")
        .def("step", &PythonScene::step, arg("duration_s"), arg("position_m"),
             "Moves the needle to position_m on a straight line within duration_s; returns the force, N.")
        .def(
            "follow", &PythonScene::follow, arg("time_s"), arg("position_m"),
            R"(Resets, then moves the needle through position_m, shape (n,), at the times time_s, shape (n,), ascending.

Returns a dict of arrays of shape (n,): force_tissue_N, force_fixture_N, position_surface_m.)")
        .def("place_fixture", &PythonScene::place_fixture, arg("position_m"), arg("present") = true,
             "Moves, removes or returns the first forbidden region.")
        .def_property_readonly("force_N", &PythonScene::force_N, "Of tissue and fixtures together.")
        .def_property_readonly("force_tissue_N", &PythonScene::force_tissue_N, "Of tissue.")
        .def_property_readonly("force_fixture_N", &PythonScene::force_fixture_N, "Of fixtures.")
        .def_property_readonly("position_surface_m", &PythonScene::surface,
                               "Of the outermost surface, as the needle has moved it; NaN without tissue.")
        .def_property_readonly("time_s", &PythonScene::time_s, "Since the last reset.")
        .def_property_readonly("events", &PythonScene::events,
                               "Since the last reset: a list of (time_s, element, phase that it entered).");
}

}  // namespace thimble
