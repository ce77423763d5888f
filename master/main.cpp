// thimble-master: the handle with the operator's hand on it.
#include <memory>

#include <spdlog/spdlog.h>

#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "master/devices/open_handle.hpp"
#include "master/devices/pointer_handle.hpp"
#include "master/devices/simulated_handle.hpp"
#include "master/master_process.hpp"

namespace {

using namespace thimble;

// A person's SpaceMouse or gamepad, and the thread that talks to it.
struct HidInput {
    HidInput(const HandleSettings& settings, const RuntimeSettings& runtime)
        : hand(settings.hid), handle(settings, settings.hid, hand), thread(hand, runtime) {}
    HidHand hand;
    HidHandle handle;
    HidThread thread;
};

class Master final : public NodeInstance {
  public:
    Master(const ConfigFile& file, Sockets& sockets, std::uint64_t instance, const HandleSettings& settings)
        : pointer_(settings),
          handle_(settings, read_operator_parameters(file.table("operator"))),
          real_(
              open_handle(settings, [runtime = read_runtime_settings(file)] { ask_for_realtime(runtime); })),
          hid_(settings.kind == HandleKind::kHid
                   ? std::make_unique<HidInput>(settings, read_runtime_settings(file))
                   : nullptr),
          pointed_(settings.kind == HandleKind::kPointer),
          stale_(read_master_settings(file).stale.text()),
          process_(instance, read_master_settings(file),
                   {sockets.between(Port::kMasterControl, Port::kSessionMaster),
                    sockets.outlet(Port::kNetemNeedle), sockets.inlet(Port::kMasterForce, Role::kNetem),
                    sockets.inlet(Port::kMasterPerceptCutaneous, Role::kCutaneous),
                    sockets.inlet(Port::kMasterPerceptVisual, Role::kVisual)},
                   chosen<HapticDevice>(), chosen<OperatorPort>()) {
        process_.join_stop_line(*sockets.inlet_for_all(Port::kMasterStop), sockets.stop_outlets());
        if (real_) spdlog::info("handle: {}", real_->name());
        if (pointed_) process_.follow_hand(*sockets.inlet(Port::kMasterHand, Role::kVisual), pointer_);
    }

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        report["samples"] = process_.samples();
        report["samples_skipped"] = process_.samples_skipped();
        report["stale"] = stale_;
        report["guard"] = {{"tripped", process_.guard().tripped()},
                           {"words", process_.guard().words()},
                           {"cut", process_.guard().cut()},
                           {"most_given_out_J", process_.guard().most_given_out_J()}};
        report["round_trip"] = quantiles(process_.round_trip().age());  // of the last trial, as the next
        report["hold"] = quantiles(process_.round_trip().hold());
        if (real_) real_->describe(report["handle"]);
        if (hid_)
            report["hid"] = {{"attachments", hid_->hand.attachments()},
                             {"bad_reports", hid_->hand.bad_reports()}};
    }

  private:
    template <class Seam>
    Seam& chosen() {
        if (real_) return *real_;
        if (hid_) return hid_->handle;
        return pointed_ ? static_cast<Seam&>(pointer_) : handle_;
    }

    // One of them is used; the others lie idle.
    PointerHandle pointer_;
    SimulatedHandle handle_;
    std::unique_ptr<RealHandle> real_;
    std::unique_ptr<HidInput> hid_;
    bool pointed_;
    std::string stale_;
    MasterProcess process_;
};

}  // namespace

int main(int argc, char** argv) {
    bool pointer = false;
    NodeProgram program;
    program.name = "thimble-master";
    program.description =
        "Reads the handle 1000 times a second, sends the needle to thimble-slave-sim through thimble-netem, "
        "and gives "
        "the returned force to the handle. The handle is simulated, with a virtual operator's hand on it, or "
        "drawn by a "
        "person's pointer, SpaceMouse or gamepad, or a real one (docs/handles.md).";
    program.example = "thimble-master --config deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "master", "guard", "handle", "operator"};
    program.flags = {
        {"--pointer", "a person's pointer draws the handle, instead of [handle].device", &pointer}};
    program.build = [&pointer](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        HandleSettings settings = read_handle_settings(file.table("handle"));
        if (pointer) settings.kind = HandleKind::kPointer;
        return std::make_unique<Master>(file, sockets, instance, settings);
    };
    return run_node_program(program, argc, argv);
}
