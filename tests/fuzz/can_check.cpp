#include <algorithm>
#include <vector>

#include "common/queue_channel.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"
#include "cutaneous_node/emulator/drive_emulator.hpp"
#include "cutaneous_node/touchdiver/touchdiver_actuator.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

// Receives the frames that the check gives it. It checks what is sent, and passes nothing on.
class HostileBus final : public CanBus {
  public:
    void send(const CanFrame& frame) override {
        well_formed = well_formed && frame.length <= 8;
        const bool target = cob_base(frame.id) == cob(CobBase::kReceive1);
        if (target && (load(frame, 0, 2) & 0x0fU) == kControlEnable)
            pressed = pressed || load(frame, 2, 2) > 1000;
    }
    void flush() override {}
    bool down() const override { return false; }
    bool receive(SessionTime, CanFrame& frame) override {
        if (frames.empty()) return false;
        frame = frames.back();
        frames.pop_back();
        return true;
    }

    std::vector<CanFrame> frames;
    bool well_formed = true, pressed = false;
};

std::vector<CanFrame> frames_of(Bytes bytes) {
    std::vector<CanFrame> frames;
    for (std::size_t at = 0; at + 13 <= bytes.size(); at += 13) {
        CanFrame frame;
        for (std::size_t i = 0; i < 4; ++i) frame.id |= std::uint32_t{bytes[at + i]} << (8 * i);
        // Most identifiers are those of a receiver.
        if ((frame.id & 0x1000U) != 0) frame.id &= 0x783U;
        frame.length = std::min<std::uint8_t>(bytes[at + 4], 8);
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 5, 8, frame.data.begin());
        frames.push_back(frame);
    }
    std::reverse(frames.begin(), frames.end());
    return frames;
}

const char* flaw_of_datagram(Bytes bytes) {
    QueuePipe pipe;
    CannelloniBus near(pipe.a), far(pipe.b);
    if (bytes.size() > kMaxDatagramBytes) return nullptr;
    if (!bytes.empty()) pipe.a.send(bytes);
    CanFrame frame;
    SessionTime now{};  // so much later that no sequence number of the other sender counts any more
    while (far.receive(now += std::chrono::seconds{1}, frame)) {
        if (frame.length > 8) return "a frame of more than 8 bytes";
        near.send(frame);
        near.flush();
        CanFrame again;
        if (const std::size_t before = far.counters().malformed;
            !far.receive(now += std::chrono::seconds{1}, again) && before == far.counters().malformed) {
            return "a frame that does not come back";
        }
    }
    return nullptr;
}

const char* flaw_of_bus(Bytes bytes) {
    if (const char* flaw = flaw_of_datagram(bytes)) return flaw;
    static const DriveSettings settings = [] {  // once: reading it takes longer than all the rest
        const ConfigFile file = ConfigFile::parse("bus = \"can0\"", "fuzz");
        return read_drive_settings(file.root());
    }();
    HostileBus to_master, to_drive;
    DriveActuator actuator(settings, 1.5, to_master);
    DriveEmulator drive(1, PlantParameters{});
    SessionTime now{};
    actuator.tick(now);
    drive.reset(now, to_drive);
    for (const CanFrame& frame : frames_of(bytes)) {
        now += std::chrono::milliseconds{1};
        to_master.frames.push_back(frame);
        actuator.command(now, Finger::kIndex, 1.5);
        actuator.tick(now);
        if (frame.id < 0x800U) drive.on_frame(now, frame, to_drive);
        drive.tick(now, to_drive);
    }
    if (actuator.output(now).force_N != 0) return "a force without drives";
    if (!to_master.well_formed || !to_drive.well_formed) return "a frame of more than 8 bytes is sent";
    return to_master.pressed ? "a torque above the drive's rated one" : nullptr;
}

// The same bytes from TouchDIVERs' middleware: a connection that is open, and says them.
class HostileStream final : public ByteStream {
  public:
    explicit HostileStream(std::string_view words) : words_(words) {}
    void connect() override { state_ = State::kOpen; }
    State state() override { return state_; }
    std::size_t send(std::string_view bytes) override {
        pressed = pressed || bytes.find("force:0.3000") != std::string_view::npos;
        return bytes.size();
    }
    std::size_t receive(std::span<char> room) override {
        const std::size_t size = words_.copy(room.data(), room.size());
        words_.remove_prefix(size);
        return size;
    }
    void close() override { state_ = State::kClosed; }
    std::string_view why() const override { return ""; }

    bool pressed = false;

  private:
    std::string_view words_;
    State state_ = State::kClosed;
};

const char* flaw_of_middleware(Bytes bytes) {
    HostileStream stream(text_of(bytes));
    TouchDiverActuator actuator(TouchDiverSettings{}, 1.5, stream);
    SessionTime now{};
    for (int ms = 0; ms < 20; ++ms) {
        actuator.command(now, Finger::kIndex, 99);
        actuator.tick(now);
        now += std::chrono::milliseconds{1};
    }
    const bool runs = text_of(bytes).find("RUNNING") != std::string_view::npos;
    if (!runs && (stream.pressed || actuator.fault().empty()))
        return "a force without a middleware that runs";
    return actuator.output(now).force_N > 1.5 ? "a force above the limit" : nullptr;
}

}  // namespace

Verdict check_can(Bytes bytes) {
    const char* flaw = flaw_of_bus(bytes);
    if (flaw == nullptr) flaw = flaw_of_middleware(bytes);
    return {false, flaw != nullptr ? flaw : ""};
}

}  // namespace thimble
