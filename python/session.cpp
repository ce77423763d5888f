// thimble.Session: a session of all six programs in virtual time, step by step, with the virtual operator's hand or Python's.
#include <charconv>
#include <cmath>
#include <functional>

#include "common/error.hpp"
#include "python/bindings.hpp"
#include "python/driven_session.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

// Numbers are numbers, and what is absent is None. A seed has more digits than a double.
py::object cell(std::string_view text) {
    if (text.empty()) return py::none();
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return py::str(std::string(text));
    return text.find_first_of(".einf") == std::string_view::npos
               ? py::object(py::int_(py::str(std::string(text))))
               : py::object(py::float_(value));
}

py::dict row_of(const TrialRecord& record) {
    const TrialRow row = make_row(record);
    py::dict cells;
    for (const auto& column : trial_columns()) {
        fmt::memory_buffer text;
        column.write(text, row);
        cells[py::str(std::string(column.name))] = cell({text.data(), text.size()});
    }
    return cells;
}

template <class Value>
py::object column_of(const std::vector<TrajectorySample>& samples, Value TrajectorySample::*member) {
    py::array_t<Value> values(static_cast<py::ssize_t>(samples.size()));
    Value* next = values.mutable_data();
    for (const TrajectorySample& sample : samples) *next++ = sample.*member;
    return values;
}

py::dict trajectory_of(const TrialRecord& record) {
    const std::vector<TrajectorySample>& samples = record.samples;
    py::dict columns;
    columns["time_s"] = column_of(samples, &TrajectorySample::time_s);
    columns["position_needle_m"] = column_of(samples, &TrajectorySample::position_needle_m);
    columns["position_surface_m"] = column_of(samples, &TrajectorySample::position_surface_m);
    columns["force_tissue_N"] = column_of(samples, &TrajectorySample::force_tissue_N);
    columns["force_fixture_N"] = column_of(samples, &TrajectorySample::force_fixture_N);
    columns["force_total_N"] = column_of(samples, &TrajectorySample::force_total_N);
    columns["contact_time_s"] = column_of(samples, &TrajectorySample::contact_time_s);
    columns["fixture_present"] = column_of(samples, &TrajectorySample::fixture_present);
    return columns;
}

Modality modality_of(const std::string& text) {
    const auto modality = find_modality(text);
    if (!modality) throw Error(ExitCode::kUsage, "modality \"{}\": is none of HF, CF, CCF, VF", text);
    return *modality;
}

class PythonSession {
  public:
    PythonSession(const py::object& session, const std::string& hand,
                  const std::map<std::string, double>& changes)
        : session_(settings_from(session, changes), driver_of(hand)) {}

    void start(const std::string& modality, std::optional<double> delay_s, std::uint32_t experiment,
               std::uint32_t subject, std::uint32_t trial, std::optional<std::uint64_t> seed,
               std::optional<double> fixture_m, bool removes_fixture) {
        TrialChoice choice;
        choice.conditions.modality = modality_of(modality);
        choice.conditions.experiment = experiment;
        choice.conditions.subject = subject;
        choice.conditions.trial = trial;
        choice.conditions.removes_fixture = removes_fixture;
        choice.delay_s = delay_s;
        choice.seed = seed;
        choice.fixture_m = fixture_m;
        mine().start(choice);
    }

    // In parts, so that Ctrl-C works and other threads run.
    bool step(std::optional<double> until_s) {
        if (!until_s) return mine().step();
        if (std::isnan(*until_s)) throw Error(ExitCode::kUsage, "until_s is no number");
        constexpr int kInstants = 20000;  // some 10 ms of work
        for (bool more = true; more; check_signals()) {
            DrivenSession& session = mine();
            const Stepping stepping(busy_);
            const py::gil_scoped_release others_go_on;
            more = session.advance(*until_s, kInstants);
        }
        return session_.running();
    }

    py::dict run() {
        step(std::numeric_limits<double>::infinity());
        return trial();
    }

    void hand(double position_m, bool engaged) { mine().hand(position_m, engaged); }
    void change_delay(double delay_s) { mine().change_delay(delay_s); }
    void stop() { mine().stop(); }
    py::dict trial() { return row_of(mine().record()); }
    py::dict trajectory() { return trajectory_of(mine().record()); }
    DrivenState state() { return mine().state(); }
    double timeout_s() const { return session_.timeout_s(); }

  private:
    // Only while the interpreter's lock is given away.
    struct Stepping {
        explicit Stepping(bool& busy_now) : busy(busy_now) { busy = true; }
        ~Stepping() { busy = false; }
        Stepping(const Stepping&) = delete;
        Stepping& operator=(const Stepping&) = delete;
        bool& busy;
    };

    DrivenSession& mine() {
        if (busy_)
            throw Error(ExitCode::kUsage,
                        "another thread steps this session: each thread needs one of its own");
        return session_;
    }
    static Driver driver_of(const std::string& text) {
        if (text == "operator") return Driver::kOperator;
        if (text == "python") return Driver::kPython;
        throw Error(ExitCode::kUsage, "hand \"{}\": is neither \"operator\" nor \"python\"", text);
    }

    DrivenSession session_;
    bool busy_ = false;  // changes under the interpreter's lock
};

struct StateField {
    const char* name;
    std::function<py::object(const DrivenState&)> value;
    const char* help;
};

template <auto Member>
StateField field(const char* name, const char* help) {
    return {name, [](const DrivenState& state) { return py::cast(state.*Member); }, help};
}

const std::vector<StateField>& state_fields() {
    static const std::vector<StateField> kFields{
        field<&DrivenState::now_s>("now_s", "The session's clock, seconds; a trial begins a little after 0."),
        field<&DrivenState::time_s>("time_s", "Of the trial's newest sample, seconds since its first one."),
        field<&DrivenState::running>("running", "Whether a trial runs."),
        field<&DrivenState::needle_m>("needle_m", "Tip of the needle, undelayed, metres into the tissue."),
        field<&DrivenState::surface_m>("surface_m", "The tissue's surface, undelayed, metres."),
        field<&DrivenState::fixture_m>("fixture_m",
                                       "Where the trial's fixture is, metres; no subject sees it."),
        field<&DrivenState::handle_m>("handle_m", "The handle, metres."),
        field<&DrivenState::force_hand_N>("force_hand_N",
                                          "Of the handle, newtons; positive pushes the hand out."),
        field<&DrivenState::force_finger_N>("force_finger_N", "Of the fingertip device, newtons, 0 or more."),
        field<&DrivenState::finger>("finger", "Which finger feels it: \"index\", \"thumb\" or \"\"."),
        field<&DrivenState::force_bar_N>("force_bar_N", "What the bar on the screen shows, newtons."),
        field<&DrivenState::force_tissue_N>("force_tissue_N", "Of tissue at the needle, undelayed, newtons."),
        field<&DrivenState::force_fixture_N>("force_fixture_N",
                                             "Of the fixture at the needle, undelayed, newtons."),
        field<&DrivenState::contact_s>("contact_s", "Unbroken contact with the fixture, seconds."),
        field<&DrivenState::beeped>("beeped", "Whether the trial's beep has sounded."),
        field<&DrivenState::outcome>("outcome",
                                     "\"completed\", \"timeout\", ...; \"none\": the trial has not ended.")};
    return kFields;
}

py::dict state_dict(PythonSession& session) {
    const DrivenState state = session.state();
    py::dict values;
    for (const StateField& field : state_fields()) values[field.name] = field.value(state);
    return values;
}

}  // namespace

void add_session(py::module_& module) {
    using py::arg;
    py::class_<PythonSession> session(
        module, "Session", R"(A session of all programs in virtual time: same bits as `thimble study`.

session: None (the defaults, which are the paper's), the path of a session file, the name of one that comes with Thimble, or a dictionary
of its tables. changes: dotted keys and numbers, as {"handle.friction_N": 0.5}. hand: "operator", the virtual operator, or "python", whose
hand() says where the handle is drawn, through a spring ([handle] coupling).

    session = thimble.Session(hand="python")
    session.start("CF", delay_s=0.05)
    while session.step(session.now_s + 0.01):
        session.hand(position_m=0.1 * session.time_s))");
    session
        .def(py::init<const py::object&, const std::string&, const std::map<std::string, double>&>(),
             arg("session") = py::none(), py::kw_only(), arg("hand") = "operator",
             arg("changes") = std::map<std::string, double>{})
        .def("start", &PythonSession::start, arg("modality") = "HF", py::kw_only(),
             arg("delay_s") = py::none(), arg("experiment") = 3, arg("subject") = 1, arg("trial") = 1,
             arg("seed") = py::none(), arg("fixture_m") = py::none(), arg("removes_fixture") = false,
             R"(Begins a trial in a fresh session, whose clock begins at 0. A running trial is dropped.

delay_s: of the force, one way; None: the last one of the session. seed: None: the session's. fixture_m: metres; None: as drawn for
this seed, subject and trial.)")
        .def(
            "step", &PythonSession::step, arg("until_s") = py::none(),
            R"(Lets time pass: until the session's clock is at until_s, seconds, or, with None, to the next event.

Returns whether the trial still runs. The clock goes from event to event, so it may pass until_s by a part of a millisecond.)")
        .def("run", &PythonSession::run, "To the end of the trial; returns its row of trials.csv, a dict.")
        .def("hand", &PythonSession::hand, arg("position_m"), arg("engaged") = true,
             "Where Python's hand wants the handle from now on, metres; engaged=False lets go.")
        .def("change_delay", &PythonSession::change_delay, arg("delay_s"),
             "The force's delay from now on, seconds, one way.")
        .def("stop", &PythonSession::stop, "Ends the running trial; its outcome is \"interrupted\".")
        .def("state", &state_dict, "All values below as a dict.")
        .def("trial", &PythonSession::trial,
             "The trial's row of trials.csv so far, a dict (docs/studies.md).")
        .def("trajectory", &PythonSession::trajectory,
             R"(The trial's samples so far, a dict of arrays of shape (n,), one sample per millisecond.

time_s, position_needle_m, position_surface_m, force_tissue_N, force_fixture_N, force_total_N, contact_time_s, fixture_present (bool).)")
        .def_property_readonly("timeout_s", &PythonSession::timeout_s, "[trial] timeout_s.");
    for (const StateField& field : state_fields()) {
        session.def_property_readonly(
            field.name, [value = field.value](PythonSession& self) { return value(self.state()); },
            field.help);
    }
}

}  // namespace thimble
