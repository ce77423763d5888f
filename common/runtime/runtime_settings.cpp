#include "common/runtime/runtime_settings.hpp"

#include "common/runtime/core_choice.hpp"

namespace thimble {

RuntimeSettings read_runtime_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("runtime");
    RuntimeSettings s;
    s.realtime_scheduling = table.boolean("realtime_scheduling", s.realtime_scheduling);
    s.priority = static_cast<int>(table.integer("priority", s.priority, 1, 98));
    s.allowed_miss_fraction = table.number("allowed_miss_fraction", s.allowed_miss_fraction, 0, 1);
    s.overrun = static_cast<OverrunPolicy>(table.choice("overrun", 0, {"warn", "rest", "stop"}));
    read_core(file);  // whoever reads this table knows all of its keys
    s.overrun_limit = static_cast<unsigned>(table.integer("overrun_limit", s.overrun_limit, 1, 100'000));
    return s;
}

}  // namespace thimble
