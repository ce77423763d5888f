// thimble-igtl, heard through OpenIGTLink's own library.
#include <cstring>
#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <igtlUnit.h>
#include <map>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/real_run.hpp"
#include "tests/unit/log/written_log.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// The newest message of each kind at one client.
struct HeardByIgtl {
    std::map<std::string, std::vector<double>> z_mm;
    std::vector<double> force_N;
    igtl::igtlUnit unit = 0;
    std::string state, status;
    int code = 0;
    unsigned messages = 0;
};

class IgtlListener {
  public:
    explicit IgtlListener(int port) {
        EXPECT_EQ(socket_->ConnectToServer("127.0.0.1", port), 0);
        socket_->SetReceiveTimeout(static_cast<int>(kPatience / std::chrono::milliseconds{1}));
    }
    ~IgtlListener() { socket_->CloseSocket(); }
    IgtlListener(const IgtlListener&) = delete;
    IgtlListener& operator=(const IgtlListener&) = delete;

    // 3D Slicer of today begins with a STATUS of version 2, whose body a reader of version 1 does not understand.
    void say_version_2() {
        std::vector<std::uint8_t> message(58 + 60, 0xEE);
        message[0] = 0;
        message[1] = 2;
        std::memcpy(&message[2], "STATUS\0\0\0\0\0\0", 12);
        const std::uint64_t bytes_big_endian = std::uint64_t{60} << 56;
        std::memcpy(&message[42], &bytes_big_endian, 8);
        EXPECT_EQ(socket_->Send(message.data(), static_cast<int>(message.size())), 1);
    }

    // False at the end of the connection.
    bool hear() {
        const auto header = igtl::MessageHeader::New();
        header->InitPack();
        if (socket_->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize())
            return false;
        EXPECT_EQ(static_cast<const std::uint8_t*>(header->GetPackPointer())[1], 1);  // version
        header->Unpack();
        ++heard.messages;
        const std::string type = header->GetDeviceType(), name = header->GetDeviceName();
        if (type == "TRANSFORM") {
            igtl::Matrix4x4 matrix;
            body<igtl::TransformMessage>(header)->GetMatrix(matrix);
            heard.z_mm[name].push_back(static_cast<double>(matrix[2][3]));
        } else if (type == "SENSOR") {
            const auto sensor = body<igtl::SensorMessage>(header);
            heard.force_N.clear();
            for (unsigned i = 0; i < sensor->GetLength(); ++i) heard.force_N.push_back(sensor->GetValue(i));
            heard.unit = sensor->GetUnit();
        } else if (type == "STRING") {
            heard.state = body<igtl::StringMessage>(header)->GetString();
        } else if (type == "STATUS") {
            const auto status = body<igtl::StatusMessage>(header);
            heard.code = status->GetCode();
            heard.status = status->GetStatusString();
        } else {
            ADD_FAILURE() << type << ' ' << name;
            return false;
        }
        return true;
    }

    HeardByIgtl heard;

  private:
    template <class Kind>
    typename Kind::Pointer body(const igtl::MessageHeader::Pointer& header) {
        auto message = Kind::New();
        message->SetMessageHeader(header);
        message->AllocatePack();
        EXPECT_EQ(socket_->Receive(message->GetPackBodyPointer(), message->GetPackBodySize()),
                  message->GetPackBodySize());
        EXPECT_NE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY, 0);  // the CRC is right, too
        return message;
    }

    igtl::ClientSocket::Pointer socket_ = igtl::ClientSocket::New();
};

// thimble-igtl on a port that the kernel chose.
class IgtlProgram {
  public:
    explicit IgtlProgram(std::vector<std::string> arguments)
        : child_(built_programs() / "thimble-igtl", listening(std::move(arguments)), folder_ / "words") {}

    int port() {
        std::smatch found;
        std::string words;
        wait_until([&] {
            return std::regex_search(words = read_text(folder_ / "words"), found, pattern_) || child_.poll();
        });
        return found.empty() ? 0 : std::stoi(found[1]);
    }
    int end() { return child_.wait(kPatience).value_or(-1); }
    std::string words() const { return read_text(folder_ / "words"); }

  private:
    static std::vector<std::string> listening(std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"--listen", "0", "--rate-Hz", "100"});
        return arguments;
    }
    std::regex pattern_{"OpenIGTLink on 127.0.0.1:([0-9]+)"};
    Folder folder_;
    Child child_;
};

TEST(Igtl, ARecordedSessionIsReadByTheirLibrary) {
    const Folder folder;
    WrittenLog log;
    log.program = "session";
    log.topic = "/slave_sim/record";
    ForceFeedback record;
    record.position_needle_m = 0.125;
    record.position_surface_m = 0.02;
    record.force_tissue_N = -1.25;
    record.force_fixture_N = -2;
    record.force_total_N = -3.25;
    record.phase = TissuePhase::kPenetrated;
    SessionControl start;
    start.modality = Modality::kCF;
    const Header header{7, {}, 0, 3, Role::kSession};
    log.bodies = {Message{header, start}, Message{header, record}};
    log.messages = {{1, 1000}, {2, 100'000'000}};
    log.write(folder / "session.mcap");

    IgtlProgram program({"--replay", (folder / "session.mcap").string()});
    IgtlListener client(program.port());
    client.say_version_2();
    while (client.hear()) {
    }
    EXPECT_EQ(program.end(), 0) << program.words();
    ASSERT_FALSE(client.heard.z_mm["Needle"].empty());
    EXPECT_EQ(client.heard.z_mm["Needle"].back(), 125);
    EXPECT_EQ(client.heard.z_mm["Surface"].back(), 20);
    EXPECT_THAT(client.heard.force_N, testing::ElementsAre(-3.25, -1.25, -2, 0));
    const auto newton = igtl::Unit::New();
    newton->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
    EXPECT_EQ(client.heard.unit, newton->Pack());
    EXPECT_EQ(client.heard.state, "trial 3 CF penetrated -3.25 N");
    EXPECT_EQ(client.heard.status, "running");
    EXPECT_EQ(client.heard.code, igtl::StatusMessage::STATUS_OK);
}

// The last that a client hears of a log with these bodies.
HeardByIgtl end_of(const std::vector<Message>& bodies) {
    const Folder folder;
    WrittenLog log;
    log.program = "session";
    log.topic = "/slave_sim/record";
    log.bodies = bodies;
    log.body_by_body = true;
    for (std::uint32_t i = 1; i <= bodies.size(); ++i) log.messages.push_back({i, 1000 * i});
    log.write(folder / "session.mcap");
    IgtlProgram program({"--replay", (folder / "session.mcap").string()});
    IgtlListener client(program.port());
    while (client.hear()) {
    }
    EXPECT_EQ(program.end(), 0) << program.words();
    return client.heard;
}

// The session tells each node of the end of a trial. No record comes after it.
TEST(Igtl, ARecordedSessionEndsAsItEnded) {
    const Header first{7, {}, 0, 3, Role::kSession}, second{7, {}, 0, 4, Role::kSession};
    SessionControl start, end;
    end.kind = ControlKind::kTrialEnd;
    end.reason = EndReason::kPeerLost;
    std::vector<Message> bodies{{first, start}, {first, ForceFeedback{}}, {first, end}, {first, end}};
    const HeardByIgtl lost = end_of(bodies);
    EXPECT_EQ(lost.status, "peer_lost");
    EXPECT_EQ(lost.code, igtl::StatusMessage::STATUS_TIME_OUT);

    end.reason = EndReason::kEmergencyStop;
    bodies.push_back({second, end});  // stopped before it began
    const HeardByIgtl stopped = end_of(bodies);
    EXPECT_EQ(stopped.status, "emergency_stop");
    EXPECT_EQ(stopped.code, igtl::StatusMessage::STATUS_PANICK_MODE);
    EXPECT_THAT(stopped.state, HasSubstr("trial 4"));
}

// Under a lab key, which the view needs too.
TEST(Igtl, ARunningSessionIsReadByTheirLibrary) {
    const Folder folder;
    SessionFile session = SessionFile::endless();
    session.more = under_lab_key(folder / "lab.key");
    const auto config = folder.write("session.toml", session.text()).string();
    RealRun run(session, {"--monitor"});
    IgtlProgram program({config, "--base-port", std::to_string(run.base_port())});
    IgtlListener client(program.port());
    const auto moved = [&] {
        const auto& z = client.heard.z_mm["Needle"];
        return !z.empty() && z.back() > z.front() + 10;
    };
    while (!moved() && client.hear()) {
    }
    EXPECT_TRUE(moved()) << run.words() << program.words();
    while (client.heard.status != "running" && client.hear()) {
    }
    EXPECT_EQ(client.heard.status, "running");
    EXPECT_THAT(client.heard.state, HasSubstr("HF"));
    run.launcher().signal(SIGTERM);
    run.end();
    while (client.heard.status != "no session" && client.hear()) {
    }
    EXPECT_EQ(client.heard.code, igtl::StatusMessage::STATUS_TIME_OUT);
}

TEST(Igtl, WhatCannotBeDoneIsSaid) {
    const auto all = run_to_end(built_programs() / "thimble-igtl", {"--listen", "0.0.0.0:0"});
    EXPECT_EQ(all.code, 2);
    EXPECT_THAT(all.words, HasSubstr("--listen: '0.0.0.0' is not this machine alone"));
    const auto none =
        run_to_end(built_programs() / "thimble-igtl", {"--listen", "0", "--replay", "none.mcap"});
    EXPECT_EQ(none.code, 5);
    EXPECT_THAT(none.words, HasSubstr("none.mcap"));
}

}  // namespace
}  // namespace thimble
