// thimble.LinkModel: a link with the keys of a session file, its packets pushed and popped, or the fates of many at once.
#include <cmath>

#include "common/error.hpp"
#include "netem/link_model.hpp"
#include "netem/link_reader.hpp"
#include "netem/profiles/profiles.hpp"
#include "python/bindings.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

SessionTime at(double seconds) { return SessionTime{from_seconds(seconds)}; }

class PythonLink {
  public:
    PythonLink(std::uint64_t seed, std::uint32_t trial, std::uint32_t direction, const std::string& way,
               const py::kwargs& settings) {
        if (way != "up" && way != "down")
            throw Error(ExitCode::kUsage, "way: is \"{}\", and must be \"up\" or \"down\"", way);
        const ConfigFile file = ConfigFile::parse(toml_text(settings), "LinkModel");
        const LinkSources sources = session_sources({}, way == "up" ? Way::kUp : Way::kDown);
        LinkSettings link;
        Timeline timeline;
        file.read_all([&] {
            link = read_link_settings(file.root(), {}, sources);
            timeline = read_timeline(file.root(), link, sources);
        });
        StreamKey key;
        key.study = seed;
        key.trial = trial;
        model_.emplace(link, key, direction, timeline);
    }

    std::uint64_t push(double now_s, const py::bytes& datagram) {
        advance(now_s);
        const std::string_view bytes = datagram;
        model_->push(
            now_, {static_cast<const std::uint8_t*>(static_cast<const void*>(bytes.data())), bytes.size()});
        return model_->counters().pushed - 1;
    }

    py::object pop(double now_s) {
        advance(now_s);
        const Departure departure = model_->pop_departure(now_);
        if (departure.bytes.empty()) return py::none();
        const auto* bytes = static_cast<const char*>(static_cast<const void*>(departure.bytes.data()));
        return py::make_tuple(departure.packet, py::bytes(bytes, departure.bytes.size()));
    }

    double next_due_s() const {
        const SessionTime due = model_->next_due();
        return due == kNever ? std::numeric_limits<double>::infinity() : to_seconds(due.time_since_epoch());
    }

    py::array_t<double> fates(const Numbers& times_s, std::size_t size_bytes) {
        if (size_bytes == 0 || size_bytes > kLargestDatagramBytes)
            throw Error(ExitCode::kUsage, "size_bytes is {}, and must be in [1, {}]", size_bytes,
                        kLargestDatagramBytes);
        const std::uint64_t first = model_->counters().pushed;
        const std::vector<std::uint8_t> datagram(size_bytes);
        std::vector<double> arrivals(static_cast<std::size_t>(times_s.size()), std::nan(""));
        const auto take_until = [&](SessionTime end) {
            while (model_->next_due() <= end && model_->next_due() != kNever) {
                now_ = std::max(now_, model_->next_due());
                const Departure departure = model_->pop_departure(now_);
                if (departure.bytes.empty() || departure.packet < first) continue;
                double& arrival = arrivals[departure.packet - first];
                if (std::isnan(arrival)) arrival = to_seconds(departure.due.time_since_epoch());
            }
        };
        for (py::ssize_t i = 0; i < times_s.size(); ++i) {
            if (i % 4096 == 0) check_signals();
            const double time_s = times_s.data()[i];
            if (std::isfinite(time_s)) take_until(at(time_s));
            advance(time_s);
            model_->push(now_, datagram);
        }
        take_until(kNever);
        return to_array(arrivals);
    }

    py::dict counters() const {
        py::dict counters;
        for (const LinkCounter& counter : kReportedCounters)
            counters[py::str(std::string(counter.name))] = model_->counters().*counter.value;
        return counters;
    }

    double mean_delay_s() const { return model_->delays().mean_s(); }
    std::size_t in_flight() const { return model_->in_flight(); }

  private:
    void advance(double now_s) {
        if (!std::isfinite(now_s) || std::abs(now_s) > 1e9 || at(now_s) < now_)
            throw Error(ExitCode::kUsage, "{} s: times are finite, and none is before the last one, {} s",
                        now_s, to_seconds(now_.time_since_epoch()));
        now_ = at(now_s);
    }

    std::optional<LinkModel> model_;
    SessionTime now_{};
};

}  // namespace

void add_link(py::module_& module) {
    using py::arg;
    py::class_<PythonLink>(module, "LinkModel", R"(One direction of an emulated network, in virtual time.

The settings are the keys of [netem.force] in a session file (docs/network.md): delay_s, jitter, jitter_spread_s, loss, rate_bits_per_s,
profile, timeline, and the others. seed, trial and direction choose the random numbers; way says which direction of a profile.
The fate of packet n depends on these and on n, on every machine.

    link = thimble.LinkModel(delay_s=0.05, jitter="normal", jitter_spread_s=0.005, loss=0.01, seed=1)
    arrivals_s = link.fates(numpy.arange(1000) * 1e-3))")
        .def(py::init<std::uint64_t, std::uint32_t, std::uint32_t, const std::string&, const py::kwargs&>(),
             py::kw_only(), arg("seed") = 1, arg("trial") = 0, arg("direction") = 0, arg("way") = "down")
        .def("push", &PythonLink::push, arg("now_s"), arg("datagram"),
             "Sends bytes at now_s (seconds); returns the packet's number, from 0 on. Times never go back.")
        .def("pop", &PythonLink::pop, arg("now_s"),
             "The next packet whose time has come, as (number, bytes), or None.")
        .def("fates", &PythonLink::fates, arg("times_s"), arg("size_bytes") = 100,
             R"(Sends a packet at each of times_s, shape (n,), seconds, ascending, and waits for all of them.

Returns the arrival times, shape (n,), seconds. NaN: the packet does not arrive. Of two copies the first counts.)")
        .def_property_readonly("next_due_s", &PythonLink::next_due_s,
                               "When the next packet may leave, seconds; inf: none is in flight.")
        .def_property_readonly("in_flight", &PythonLink::in_flight, "Packets that have not left yet.")
        .def_property_readonly("counters", &PythonLink::counters, "Packets by what became of them, a dict.")
        .def_property_readonly("mean_delay_s", &PythonLink::mean_delay_s,
                               "Of the packets that have left, seconds.");
}

}  // namespace thimble
