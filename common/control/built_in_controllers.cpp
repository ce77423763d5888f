#include "common/control/built_in_controllers.hpp"

#include <array>

namespace thimble {

const thimble_controller* controller_of(const ControlSettings& settings) {
    // In the order of Compensator, which begins with kNone.
    static constexpr std::array kTables{scaled_controller,
                                        passivity_controller,
                                        memoryless_bound_controller,
                                        least_conservative_controller,
                                        two_layer_controller,
                                        local_fixture_controller,
                                        wave_controller,
                                        two_port_controller,
                                        adaptive_fixture_controller,
                                        predicted_share_controller,
                                        four_channel_controller};
    static_assert(kTables.size() + 1 == kBuiltInCompensators.size());
    if (settings.compensator == Compensator::kNone) return nullptr;
    if (settings.compensator == Compensator::kPlugin) return settings.plugin.table;
    return &kTables.at(static_cast<std::size_t>(settings.compensator) - 1)();
}

bool has_two_ends(const ControlSettings& settings) {
    const thimble_controller* table = controller_of(settings);
    return table != nullptr && (table->capabilities & THIMBLE_BOTH_ENDS) != 0;
}

}  // namespace thimble
