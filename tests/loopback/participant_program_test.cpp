// `thimble run` with a [protocol], as an experimenter starts it: a person's session with nodes that run
// already, a power cut, a lost node, commands by pipe, folders of the wrong kind.
#include <csignal>
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/real_run.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// A session file of one trial per modality, a folder, ports, and what is run with them.
class ParticipantSessions {
  public:
    explicit ParticipantSessions(const std::string& who, double contact_hold_s = 0.5, int break_every = 1)
        : contact_hold_s_(contact_hold_s),
          break_every_(break_every),
          file_(write("session.toml", who)),
          dataset_(folder_ / "data") {}

    std::filesystem::path write(const std::string& name, const std::string& who) const {
        return folder_.write(name,
                             fmt::format("[session]\n{}\nmodalities = ['HF', 'CF']\nfixture_jitter_m = 0\n"
                                         "[fixture]\nposition_m = 0.035\n"
                                         "[trial]\ncontact_hold_s = {}\npeer_wait_s = 60\n"
                                         "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\n"
                                         "practice_trials = 0\nbreak_every = {}\nbreak_minimum_s = 0.1\n",
                                         who, contact_hold_s_, break_every_));
    }

    std::vector<std::string> arguments(const std::vector<std::string>& more) const {
        return words_in(fmt::format("run {} --out {} --base-port {}", file_.string(),
                                    dataset_.folder().string(), ports_.base()),
                        more);
    }
    Outcome run(const std::vector<std::string>& more = {}) const { return run_thimble(arguments(more)); }
    // With these words on its standard input.
    Outcome run_with_input(const std::string& input, const std::vector<std::string>& more) const {
        std::string command = fmt::format("printf '{}' | {}", input, (built_programs() / "thimble").string());
        for (const std::string& word : arguments(more)) command += " '" + word + "'";
        return run_to_end("/bin/sh", {"-c", command});
    }
    Child start(const std::vector<std::string>& more) const {
        return {built_programs() / "thimble", arguments(more), folder_ / "words"};
    }
    // The five nodes, as a lab with its own master would have them running.
    std::deque<Child> nodes() const {
        std::deque<Child> started;
        for (const char* program : kNodePrograms) {
            started.emplace_back(built_programs() / program,
                                 std::vector<std::string>{"--base-port", std::to_string(ports_.base()),
                                                          file_.string(), "--die-with-parent"},
                                 folder_ / program);
        }
        return started;
    }

    bool reaches(std::uint32_t record) const {
        return wait_until([&] {
            std::error_code absent;
            for (const auto& file :
                 std::filesystem::directory_iterator(dataset_.source(7) / "trajectories", absent)) {
                const bool wanted =
                    file.path().filename().string().starts_with(fmt::format("record{:03}", record));
                if (wanted && file.file_size(absent) > 2000) return true;
            }
            return false;
        });
    }
    std::vector<DatasetRecord> records() const { return read_records(dataset_.records(7)); }
    std::string words() const { return read_text(folder_ / "words"); }
    std::uint16_t base_port() const { return ports_.base(); }
    const Dataset& dataset() const { return dataset_; }
    const Folder& folder() const { return folder_; }

  private:
    Folder folder_;
    PortBlock ports_;
    double contact_hold_s_;
    int break_every_;
    std::filesystem::path file_;
    Dataset dataset_;
};

constexpr const char* kPerson = "subject = 'human'\nparticipant = 'P07'";

TEST(ParticipantProgram, APersonNeedsARealHandleAndGivesConsent) {
    const ParticipantSessions sessions(kPerson);
    const Outcome simulated = sessions.run({"--consent"});
    EXPECT_EQ(simulated.code, 2);
    EXPECT_THAT(simulated.words, HasSubstr("--attach"));
    EXPECT_THAT(simulated.words, HasSubstr("[handle] device to \"pointer\""));
    const Outcome unasked = sessions.run({"--attach"});
    EXPECT_EQ(unasked.code, 2);
    EXPECT_THAT(unasked.words, HasSubstr("--consent"));
    EXPECT_EQ(sessions.run({"--attach", "--consent", "--participant", "Anna"}).code, 2);
    EXPECT_EQ(sessions.run({"--attach", "--consent", "--overwrite"}).code, 2);
    EXPECT_EQ(sessions.run({"--attach", "--consent", "--resume"}).code, 2);
    EXPECT_FALSE(std::filesystem::exists(sessions.dataset().folder())) << "nothing is written before";
}

// The person is stood in for by the virtual operator of a master that the test started.
TEST(ParticipantProgram, APersonsSessionIsCutAndGoesOn) {
    const ParticipantSessions sessions(kPerson, 1);
    const auto nodes = sessions.nodes();
    const std::vector<std::string> person{"--attach", "--consent", "--age", "31", "--sex", "F"};
    {
        Child first = sessions.start(person);
        ASSERT_TRUE(sessions.reaches(2)) << sessions.words();
        first.signal(SIGKILL);
        first.wait(kPatience);
    }
    const std::string order = read_text(sessions.dataset().order(7));
    ASSERT_EQ(sessions.records().size(), 1U);
    const Outcome again = sessions.run(person);
    EXPECT_EQ(again.code, 2);
    EXPECT_THAT(again.words, HasSubstr("--resume"));

    // The order stays as it began, though the file has changed.
    static_cast<void>(sessions.write("session.toml", std::string(kPerson) + "\nseed = 2"));
    const Outcome rest = sessions.run({"--attach", "--consent", "--resume"});
    EXPECT_EQ(rest.code, 0) << rest.words;
    EXPECT_THAT(rest.words, testing::Not(HasSubstr("already has other values"))) << "age and sex are known";
    EXPECT_THAT(rest.words, HasSubstr("The one in the folder is used"));
    EXPECT_EQ(read_text(sessions.dataset().order(7)), order);
    const auto records = sessions.records();
    ASSERT_EQ(records.size(), 2U) << rest.words;
    for (const DatasetRecord& record : records) {
        EXPECT_EQ(record.row.reason, EndReason::kCompleted);
        EXPECT_EQ(record.repeat_of, 0U);
        EXPECT_EQ(record.row.conditions.study_seed, 1U);
        EXPECT_EQ(record.row.conditions.trial, record.position);
    }
    EXPECT_GT(records[1].number, 2U) << "the nodes have seen number 2";
    EXPECT_THAT(read_text(sessions.dataset().participants()), HasSubstr("sub-07\thomo sapiens\t31\tF\t"));
    EXPECT_THAT(rest.words, HasSubstr("2 of 2 trials begun"));
    EXPECT_EQ(nodes_alive(sessions.base_port()).size(), kNodePrograms.size()) << "they are not ours to end";
}

TEST(ParticipantProgram, TheExperimentersCommandsByPipe) {
    const ParticipantSessions sessions("subject = 7");
    const Outcome run = sessions.run_with_input("\\n\\nr sneezed\\n\\n", {"--commands"});
    EXPECT_EQ(run.code, 0) << run.words;
    const auto records = sessions.records();
    ASSERT_EQ(records.size(), 3U) << run.words;
    EXPECT_EQ(records[2].repeat_of, 2U);
    EXPECT_EQ(records[2].repeat_reason, "sneezed");
    const std::string data = sessions.dataset().folder().string();
    const std::vector<std::string> exclude{"dataset", "exclude", data,       "--participant", "P07",
                                           "--trial", "1",       "--reason", "phone rang"};
    EXPECT_EQ(run_thimble(exclude).code, 0);
    EXPECT_EQ(run_thimble(exclude).code, 2);  // it is already
    const Outcome analysed = run_thimble({"analyse", data});
    for (const char* file : {"participants.json", "dataset_description.json"})
        EXPECT_EQ(run_thimble({"analyse", data, "--out", data + '/' + file}).code, 2) << file;
    EXPECT_EQ(analysed.code, 0) << analysed.words;
    EXPECT_THAT(analysed.words, HasSubstr("1 of 3 records of 1 participant"));
    EXPECT_THAT(analysed.words, HasSubstr("sub-07 trial 1 (record 1): phone rang"));
    EXPECT_THAT(analysed.words, HasSubstr("sub-07 trial 2 (record 2): sneezed"));
    const Outcome included = run_thimble({"dataset", "include", data, "--participant", "P07", "--trial", "1",
                                          "--reason", "it was another phone"});
    EXPECT_EQ(included.code, 0) << included.words;
    EXPECT_THAT(run_thimble({"analyse", data}).words, HasSubstr("2 of 3 records of 1 participant"));
    const Outcome corrected = run_thimble({"dataset", "correct", data, "--participant", "P07", "--column",
                                           "age", "--value", "95", "--reason", "typing error", "--by", "LS"});
    EXPECT_EQ(corrected.code, 0) << corrected.words;
    EXPECT_THAT(corrected.words, HasSubstr("age of P07 is now 89+: typing error"));
    EXPECT_THAT(read_text(sessions.dataset().participants()), HasSubstr("\t89+\t"));
    const std::string notes = read_text(sessions.dataset().corrections());
    for (const char* part : {"\tit was another phone\n", "\tLS\t", "\tage\t", "\t89+\ttyping error\n"})
        EXPECT_THAT(notes, HasSubstr(part));
}

TEST(ParticipantProgram, ALostNodeIsStartedAnewAndItsTrialRepeated) {
    const ParticipantSessions sessions("subject = 7", 1);
    Child run = sessions.start({});
    std::vector<pid_t> victims, masters;
    EXPECT_TRUE(wait_until([&] {
        victims = node_pids(sessions.base_port(), "thimble-visual");
        masters = node_pids(sessions.base_port(), "thimble-master");
        return victims.size() == 1 && masters.size() == 1;
    }));
    ASSERT_TRUE(sessions.reaches(1)) << sessions.words();
    ASSERT_EQ(victims.size(), 1U);
    kill(victims.front(), SIGKILL);
    ASSERT_TRUE(sessions.reaches(2)) << sessions.words();
    EXPECT_NE(node_pids(sessions.base_port(), "thimble-visual"), victims);
    EXPECT_EQ(node_pids(sessions.base_port(), "thimble-master"), masters) << "who lives goes on";
    EXPECT_EQ(run.wait(3 * kPatience), 0) << sessions.words();
    const auto records = sessions.records();
    ASSERT_EQ(records.size(), 3U) << sessions.words();
    EXPECT_EQ(records[0].row.reason, EndReason::kPeerLost);
    EXPECT_EQ(records[0].row.lost_peer, Role::kVisual);
    EXPECT_THAT(sessions.words(), HasSubstr("thimble-visual ended with code 137"));
    EXPECT_EQ(records[1].repeat_of, 1U);
    EXPECT_EQ(records[1].repeat_reason, "peer_lost_visual");
    EXPECT_EQ(records[1].row.reason, EndReason::kCompleted);
    EXPECT_THAT(nodes_alive(sessions.base_port()), testing::IsEmpty());
}

TEST(ParticipantProgram, CtrlCEndsItInOrder) {
    const ParticipantSessions sessions("subject = 7", kEndlessHold_s);
    Child run = sessions.start({});
    ASSERT_TRUE(sessions.reaches(1)) << sessions.words();
    run.signal(SIGINT);
    EXPECT_EQ(run.wait(kPatience), 1) << sessions.words();
    ASSERT_EQ(sessions.records().size(), 1U);
    EXPECT_EQ(sessions.records()[0].row.reason, EndReason::kInterrupted);
    EXPECT_THAT(sessions.words(), HasSubstr("--resume"));
    EXPECT_THAT(nodes_alive(sessions.base_port()), testing::IsEmpty());
}

TEST(ParticipantProgram, FoldersOfTheWrongKindAreRefused) {
    const ParticipantSessions sessions(kPerson);
    sessions.dataset().open(SubjectKind::kHuman, {});
    const std::string before = read_text(sessions.dataset().description());
    const std::string data = sessions.dataset().folder().string();
    const std::string virtual_file = sessions.write("virtual.toml", "subject = 7").string();
    const std::string plain_file = sessions.folder().write("plain.toml", "").string();
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"run", virtual_file, "--out", data},
          {"run", plain_file, "--out", data},
          {"run", plain_file, "--out", data, "--overwrite"},
          {"study", "--out", data},
          {"study", "--overwrite", "--out", data},
          {"study", "--seeds", "2", "--out", data}}) {
        const Outcome refused = run_thimble(command);
        EXPECT_EQ(refused.code, 2) << refused.words;
        EXPECT_THAT(refused.words, HasSubstr("human"));
        EXPECT_THAT(refused.words, HasSubstr("--out"));
    }
    EXPECT_EQ(read_text(sessions.dataset().description()), before);

    const ParticipantSessions other(kPerson);
    std::filesystem::create_directories(other.dataset().folder());
    other.folder().write("data/trials.csv", "a virtual study\n");
    const Outcome refused = other.run({"--attach", "--consent"});
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("empty folder"));
}

// A crash between the two leaves an order without a participant, which --resume takes up.
TEST(ParticipantProgram, TheOrderIsWrittenBeforeTheParticipant) {
    const ParticipantSessions sessions(kPerson);
    sessions.dataset().open(SubjectKind::kHuman, {});
    sessions.folder().write("data/orders", "a file in the folder's place\n");
    const Outcome failed = sessions.run({"--attach", "--consent"});
    EXPECT_EQ(failed.code, 2) << failed.words;
    EXPECT_THAT(failed.words, HasSubstr("data/orders"));
    EXPECT_FALSE(std::filesystem::exists(sessions.dataset().participants())) << failed.words;
}

// `thimble run --monitor`: a view watches, and sends the orders that a participant session knows.
bool watch(PlayedView& view, const std::function<bool()>& done) {
    return wait_until([&] {
        view.listen(wall_now());
        return done();
    });
}

TEST(MonitorOfARun, ShowsTheTrialAndTakesQuit) {
    RealRun run(SessionFile::endless(), {"--monitor"});
    PlayedView view(run.base_port());
    ASSERT_TRUE(watch(view, [&] { return view.monitor().phase == TissuePhase::kPenetrated; })) << run.words();
    EXPECT_TRUE(view.running());
    EXPECT_EQ(view.monitor().position_fixture_m, 0.035);
    EXPECT_GT(view.monitor().accepted, 100U);
    EXPECT_TRUE(watch(view, [&] { return view.monitor().one_way_s >= 0; }));
    view.order(wall_now(), OrderKind::kDelay, 0.4);  // a condition of the trial: refused
    const std::uint64_t before = view.heard();
    EXPECT_TRUE(watch(view, [&] { return view.heard() > before + 20; }));
    EXPECT_EQ(view.monitor().network_delay_s, 0);
    view.order(wall_now(), OrderKind::kQuit);
    EXPECT_EQ(run.end(), 1);
    EXPECT_EQ(run.only_reason(), EndReason::kInterrupted);
}

TEST(MonitorOfAParticipantSession, ATrialIsRepeatedWhenTheViewAsks) {
    const ParticipantSessions sessions("subject = 7", 0.2, 10);
    Child child = sessions.start({"--monitor"});
    PlayedView view(sessions.base_port());
    ASSERT_TRUE(watch(view, [&] { return view.running(); })) << sessions.words();
    EXPECT_EQ(view.monitor().trials, 2U);
    Order repeat;
    repeat.kind = OrderKind::kRepeat;
    repeat.trial = view.trial();
    for (int said = 0; said < 2; ++said) view.order(wall_now(), repeat);
    EXPECT_TRUE(watch(view, [&] { return child.poll().has_value(); }));
    EXPECT_EQ(child.wait(kPatience).value_or(-1), 0) << sessions.words();
    const auto records = sessions.records();
    ASSERT_EQ(records.size(), 3U) << sessions.words();
    EXPECT_EQ(records[2].position, records[0].position);
    EXPECT_NE(records[2].repeat_of, 0U);
}

}  // namespace
}  // namespace thimble
