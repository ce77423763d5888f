#include <algorithm>

#include "master/devices/hid/hid_axes.hpp"

namespace thimble {
namespace {

constexpr std::string_view kNoHand = "3Dconnexion device without a cap";

constexpr std::array kModels{
    HidModel{0x046d, 0xc603, "SpaceMouse Plus XT"},
    HidModel{0x046d, 0xc605, "CADman"},
    HidModel{0x046d, 0xc606, "SpaceMouse Classic"},
    HidModel{0x046d, 0xc621, "SpaceBall 5000"},
    HidModel{0x046d, 0xc623, "SpaceTraveler"},
    HidModel{0x046d, 0xc625, "SpacePilot"},
    HidModel{0x046d, 0xc626, "SpaceNavigator"},
    HidModel{0x046d, 0xc627, "SpaceExplorer"},
    HidModel{0x046d, 0xc628, "SpaceNavigator for Notebooks"},
    HidModel{0x046d, 0xc629, "SpacePilot Pro"},
    HidModel{0x046d, 0xc62b, "SpaceMouse Pro"},
    HidModel{0x046d, 0xc640, "NuLOOQ"},
    // It would move the needle by itself: its reports have another layout than its descriptor says.
    HidModel{0x057e, 0x2009, "Switch Pro Controller", false},
    HidModel{0x256f, 0xc62c, kNoHand, false},
    HidModel{0x256f, 0xc62e, "SpaceMouse Wireless (cable)"},
    HidModel{0x256f, 0xc62f, "SpaceMouse Wireless (receiver)"},
    HidModel{0x256f, 0xc631, "SpaceMouse Pro Wireless (cable)"},
    HidModel{0x256f, 0xc632, "SpaceMouse Pro Wireless (receiver)"},
    HidModel{0x256f, 0xc633, "SpaceMouse Enterprise"},
    HidModel{0x256f, 0xc635, "SpaceMouse Compact"},
    HidModel{0x256f, 0xc636, "SpaceMouse Module"},
    HidModel{0x256f, 0xc638, "SpaceMouse Pro Wireless (Bluetooth)"},
    HidModel{0x256f, 0xc63a, "SpaceMouse Wireless (Bluetooth)"},
    HidModel{0x256f, 0xc650, "CadMouse", false},
    HidModel{0x256f, 0xc651, "CadMouse", false},
    HidModel{0x256f, 0xc652, "3Dconnexion Universal Receiver"},
    HidModel{0x256f, 0xc654, "CadMouse", false},
    HidModel{0x256f, 0xc655, "CadMouse", false},
    HidModel{0x256f, 0xc656, "CadMouse", false},
    HidModel{0x256f, 0xc657, "CadMouse", false},
    HidModel{0x256f, 0xc658, "CadMouse", false},
    HidModel{0x256f, 0xc664, kNoHand, false},
    HidModel{0x256f, 0xc665, kNoHand, false},
    HidModel{0x256f, 0xc668, kNoHand, false},
};

}  // namespace

std::optional<HidModel> find_hid_model(std::uint16_t vendor, std::uint16_t product) {
    const auto* const found = std::find_if(kModels.begin(), kModels.end(), [&](const HidModel& model) {
        return model.vendor == vendor && model.product == product;
    });
    return found == kModels.end() ? std::nullopt : std::optional(*found);
}

}  // namespace thimble
