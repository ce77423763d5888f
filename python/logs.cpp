// thimble.read_log: a log's messages (MCAP, docs/log.md) as columns.
#include "common/error.hpp"
#include "python/bindings.hpp"
#include "session/log/logged_file.hpp"
#include "session/log/packet_fields.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

using Column = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint64_t>,
                            std::vector<bool>, std::vector<std::string>>;  // in the order of FieldValue

void append(Column& column, const FieldValue& value) {
    std::visit(
        [&](const auto& one) {
            using Values = std::vector<std::decay_t<decltype(one)>>;
            if (!std::holds_alternative<Values>(column)) column = Values{};
            std::get<Values>(column).push_back(one);
        },
        value);
}

py::object array_of(const Column& column) {
    const py::module_ numpy = py::module_::import("numpy");
    return std::visit(
        [&](const auto& values) -> py::object {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, bool>) {
                return numpy.attr("array")(py::cast(values));
            } else {
                return py::array_t<Value>(static_cast<py::ssize_t>(values.size()), values.data());
            }
        },
        column);
}

// Of one topic and kind of message.
struct Table {
    std::vector<std::pair<std::string, Column>> columns;

    void begin(const PacketFields& fields, const PacketPart& kind) {
        columns = {{"log_time_ns", {}}, {"publish_time_ns", {}}, {"sent", {}}};
        for (const PacketField& field : fields.header().fields)
            columns.emplace_back("header_" + field.name, Column{});
        for (const PacketField& field : kind.fields) columns.emplace_back(field.name, Column{});
    }
};

class LogReading {
  public:
    explicit LogReading(const std::string& path) : file_(path) {}

    void read(const std::string& topic, const std::atomic<bool>& stop) {
        file_.for_each([&](const LoggedTopic& its, const McapMessage& message) {
            if (stop || !its.readable || !its.topic.starts_with(topic)) return;
            Bytes packet;
            if (!verify_packet(message.data, aligned_, packet)) return;
            if (const PacketPart* kind = fields_.kind_of(packet)) add(its, message, packet, *kind);
        });
    }

    py::dict tables() const {
        py::dict all;
        for (const auto& [key, table] : tables_) {
            py::dict columns;
            for (const auto& [name, column] : table.columns) columns[py::str(name)] = array_of(column);
            all[py::make_tuple(key.first, key.second)] = columns;
        }
        return all;
    }

  private:
    void add(const LoggedTopic& topic, const McapMessage& message, Bytes packet, const PacketPart& kind) {
        Table& table = tables_[{topic.topic, kind.name}];
        if (table.columns.empty()) table.begin(fields_, kind);
        auto column = table.columns.begin();
        append((column++)->second, message.log_time_ns);
        append((column++)->second, message.publish_time_ns);
        append((column++)->second, topic.sent);
        for (const PacketPart* part : {&fields_.header(), &kind}) {
            for (const FieldValue& value : fields_.values(packet, *part)) append((column++)->second, value);
        }
    }

    LoggedFile file_;
    PacketFields fields_;
    std::vector<std::uint64_t> aligned_;
    std::map<std::pair<std::string, std::string>, Table> tables_;
};

py::dict read_log(const py::object& path, const std::string& topic) {
    std::atomic<bool> stop = false;
    const std::string name = py::str(path);
    const std::unique_ptr<LogReading> reading = interruptible(stop, [&] {
        auto made = std::make_unique<LogReading>(name);
        made->read(topic, stop);
        return made;
    });
    return reading->tables();
}

}  // namespace

void add_logs(py::module_& module) {
    module.def(
        "read_log", &read_log, py::arg("path"), py::arg("topic") = "",
        R"(The messages of a program's log (MCAP, docs/log.md) as numpy arrays. topic: only topics that begin so.

Returns a dict. A key is (topic, kind of message), as ("/master/needle_command", "needle_command"). A value is a dict of arrays of shape
(n,), a message each, in the order of the log: log_time_ns, publish_time_ns, sent (bool), the header's fields with "header_" before them,
and the kind's fields. A field's name ends in its unit. Enums are texts. pandas.DataFrame(value) makes a frame of it.)");
}

}  // namespace thimble
