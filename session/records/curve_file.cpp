#include "session/records/curve_file.hpp"

#include <iterator>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/csv/csv.hpp"

namespace thimble {
namespace {

constexpr std::size_t kLeading = 7;  // columns before the curves

const std::vector<std::string>& column_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list{"experiment", "subject", "trial", "modality",
                                      "delay_s",    "entered", "beeped"};
        for (const char* what : {"needle", "surface"}) {
            for (const double at : curve_grid_percent()) list.push_back(fmt::format("{}_{:g}%", what, at));
        }
        return list;
    }();
    return names;
}

void write_curve(fmt::memory_buffer& line, bool entered, const std::vector<double>& curve) {
    for (std::size_t i = 0; i < kCurvePoints; ++i) {
        line.push_back(',');
        if (entered) write_number(std::back_inserter(line), curve[i]);
    }
}

std::vector<double> read_curve(const CsvReader& reader, std::size_t first) {
    std::vector<double> curve(kCurvePoints);
    for (std::size_t i = 0; i < kCurvePoints; ++i) curve[i] = reader.field(first + i).number();
    return curve;
}

TrialCurve read_line(const CsvReader& reader) {
    constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
    TrialCurve trial;
    TrialConditions& c = trial.conditions;
    c.experiment = static_cast<std::uint32_t>(reader.field(0).integer(kMost));
    c.subject = static_cast<std::uint32_t>(reader.field(1).integer(kMost));
    c.trial = static_cast<std::uint32_t>(reader.field(2).integer(kMost));
    const auto modality = find_modality(reader.field(3).text);
    if (!modality) reader.field(3).fail("is none of HF, CF, CCF, VF");
    c.modality = *modality;
    c.delay_s = reader.field(4).number();
    trial.entered = reader.field(5).flag();
    trial.beeped = reader.field(6).flag();
    if (!trial.entered) return trial;
    trial.needle_percent = read_curve(reader, kLeading);
    trial.surface_percent = read_curve(reader, kLeading + kCurvePoints);
    return trial;
}

}  // namespace

CurveFile::CurveFile(const std::filesystem::path& path, IfExists if_exists) : file_(path, if_exists) {
    if (file_.is_new()) file_.write(fmt::format("{}\n", fmt::join(column_names(), ",")));
    file_.flush();
}

void CurveFile::append(const TrialCurve& trial) {
    const TrialConditions& c = trial.conditions;
    fmt::memory_buffer line;
    fmt::format_to(std::back_inserter(line), "{},{},{},{},", c.experiment, c.subject, c.trial,
                   to_string(c.modality));
    write_number(std::back_inserter(line), c.delay_s);
    fmt::format_to(std::back_inserter(line), ",{},{}", trial.entered ? 1 : 0, trial.beeped ? 1 : 0);
    write_curve(line, trial.entered, trial.needle_percent);
    write_curve(line, trial.entered, trial.surface_percent);
    line.push_back('\n');
    file_.write({line.data(), line.size()});
    file_.flush();
}

void read_curves(const std::filesystem::path& path, const TakeCurve& take, LastLine last) {
    const std::vector<std::string_view> names(column_names().begin(), column_names().end());
    CsvReader reader(path, names, ',', 0, last);
    while (reader.next()) take(read_line(reader));
}

}  // namespace thimble
