#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "common/text_file.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

// Only a fault's text may hold characters that our own tables would have to quote.
std::string csv_text(const FieldValue& value) {
    std::string text = to_text(value);
    if (!std::holds_alternative<std::string>(value)) return text;
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + '"';
}

class CsvExport {
  public:
    CsvExport(const PacketFields& fields, const std::filesystem::path& folder)
        : fields_(fields), folder_(folder) {}

    void add(const LoggedFile& file, const LoggedTopic& topic, const McapMessage& message) {
        Bytes packet;
        if (!topic.readable || !verify_packet(message.data, aligned_, packet)) return;
        const PacketPart* kind = fields_.kind_of(packet);
        if (kind == nullptr) return;
        std::string line = fmt::format("{},{},{}", message.log_time_ns, message.publish_time_ns,
                                       topic.sent ? "sent" : "received");
        for (const PacketPart* part : {&fields_.header(), kind}) {
            for (const FieldValue& value : fields_.values(packet, *part)) line += ',' + csv_text(value);
        }
        table(file, topic, *kind).write(line + '\n');
    }
    std::size_t finish() {
        for (auto& [key, table] : tables_) table.flush();
        return tables_.size();
    }

  private:
    CsvFile& table(const LoggedFile& file, const LoggedTopic& topic, const PacketPart& kind) {
        const std::tuple key(&file, topic.topic, &kind);
        const auto found = tables_.find(key);
        if (found != tables_.end()) return found->second;
        std::string name = file.name() + topic.topic + '.' + kind.name;
        std::replace(name.begin(), name.end(), '/', '.');
        CsvFile& table = tables_.try_emplace(key, folder_ / (name + ".csv"), IfExists::kRefuse).first->second;
        std::string columns = "log_time_ns,publish_time_ns,direction";
        for (const PacketField& field : fields_.header().fields) columns += ",header_" + field.name;
        for (const PacketField& field : kind.fields) columns += ',' + field.name;
        table.write(columns + '\n');
        return table;
    }

    const PacketFields& fields_;
    std::filesystem::path folder_;
    std::map<std::tuple<const LoggedFile*, std::string, const PacketPart*>, CsvFile> tables_;
    std::vector<std::uint64_t> aligned_;
};

}  // namespace

std::size_t export_csv(const std::vector<std::unique_ptr<LoggedFile>>& files,
                       const std::filesystem::path& folder, const std::string& topic) {
    make_folder(folder);
    const PacketFields fields;
    CsvExport tables(fields, folder);
    for (const auto& file : files) {
        file->for_each([&](const LoggedTopic& its, const McapMessage& message) {
            if (its.topic.starts_with(topic)) tables.add(*file, its, message);
        });
    }
    return tables.finish();
}

}  // namespace thimble
