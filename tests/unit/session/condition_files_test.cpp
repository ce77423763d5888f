// A pipe of one page that no reader empties stands for a slow disk.
#include "session/run/condition_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kSamples = 5000;  // some 30 pages

class SlowDisk {
  public:
    // In place of the file.
    explicit SlowDisk(const std::filesystem::path& file) {
        EXPECT_EQ(::mkfifo(file.c_str(), 0600), 0);
        end_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        EXPECT_GE(end_, 0);
        EXPECT_GT(::fcntl(end_, F_SETPIPE_SZ, 4096), 0);
        ::fcntl(end_, F_SETFL, 0);
    }
    ~SlowDisk() { ::close(end_); }

    // All that the writer writes until it closes the file.
    std::string take() const {
        std::string text, page(4096, '\0');
        for (ssize_t n = 0; (n = ::read(end_, page.data(), page.size())) > 0;)
            text.append(page, 0, static_cast<std::size_t>(n));
        return text;
    }

  private:
    int end_ = -1;
};

ConditionPlan plan_in(const std::filesystem::path& folder) {
    ConditionPlan plan;
    plan.out = folder / "nodes";
    plan.if_exists = IfExists::kReplace;
    return plan;
}

void add_some(ConditionFiles& files) {
    TrajectorySample sample;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        sample.time_s = 1e-3 * i;
        files.add(sample);
        if (i % 80 == 0) files.flush();
    }
}

void end(ConditionFiles& files) {
    TrialRecord record;
    record.reason = EndReason::kCompleted;
    files.end_trial(record);
}

TEST(ConditionFiles, ASlowDiskDelaysTheEndOfATrialAndNothingBefore) {
    const TemporaryDirectory folder;
    const ConditionPlan plan = plan_in(folder.path());
    std::string text;
    std::thread disk;
    {
        const SlowDisk slow(folder / "t.csv");
        ConditionFiles files(plan);
        files.begin_trial({}, 1, folder / "t.csv");
        add_some(files);  // would not return if it waited for the disk
        EXPECT_EQ(files.fault(), "");
        disk = std::thread([&] { text = slow.take(); });
        end(files);
        disk.join();
    }
    ConditionFiles files(plan);
    files.begin_trial({}, 1, folder / "fast.csv");
    add_some(files);
    end(files);
    EXPECT_EQ(text, read_text(folder / "fast.csv"));
    EXPECT_EQ(read_trajectory(folder / "fast.csv").samples.size(), kSamples);
}

// Of a program that ends in its own way: a node does not answer, or a trial is broken off.
TEST(ConditionFiles, KeepWhatWasAddedAlsoWithoutAnEnd) {
    const TemporaryDirectory folder;
    const ConditionPlan plan = plan_in(folder.path());
    const auto clocks = plan.out / "clocks_0ms.csv";
    const ClockExchange exchange{.answered = SessionTime{std::chrono::seconds{1}}};
    {
        ConditionFiles files(plan);
        files.open();
        files.add(Role::kNetem, exchange, {});
    }
    EXPECT_EQ(read_clock_file(clocks).size(), 1U);
    {
        ConditionFiles files(plan);
        files.open();
        files.begin_trial({}, 1, folder / "t.csv");
        for (int i = 0; i < 100; ++i) {
            files.add(i % 2 == 0 ? Role::kNetem : Role::kMaster, exchange, {});
            add_some(files);
        }
    }
    EXPECT_EQ(read_trajectory(folder / "t.csv").samples.size(), 100 * kSamples);
    const auto records = read_clock_file(clocks);
    ASSERT_EQ(records.size(), 100U);
    EXPECT_EQ(records[0].node, Role::kNetem);
    EXPECT_EQ(records[99].node, Role::kMaster);
}

TEST(ConditionFiles, ATrialThatIsReplacedLeavesNoChangesOfTheNetwork) {
    const TemporaryDirectory folder;
    write_events(event_path(folder / "t.csv"), {{0.3, 0.5}});
    const ConditionPlan plan = plan_in(folder.path());
    ConditionFiles files(plan);
    files.begin_trial({}, 1, folder / "t.csv");
    end(files);
    EXPECT_FALSE(std::filesystem::exists(event_path(folder / "t.csv")));
}

TEST(Reports, AnOddLogHasNoFault) {
    for (const char* report :
         {"[1]", "{}", R"({"log": null})", R"({"log": {"fault": 1}})", R"({"log": [1]})"})
        EXPECT_EQ(log_fault_in(nlohmann::ordered_json::parse(report)), "") << report;
    EXPECT_EQ(log_fault_in({{"log", {{"fault", "full"}}}}), "full");
}

TEST(ConditionFiles, AFaultOfTheDiskIsKnownSoon) {
    const TemporaryDirectory folder;
    const ConditionPlan plan = plan_in(folder.path());
    ConditionFiles files(plan);
    files.begin_trial({}, 1, folder / "t.csv");
    add_some(files);
    std::filesystem::remove(folder / "t.csv");
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds{60};
    while (files.fault().empty() && std::chrono::steady_clock::now() < limit) {
        std::this_thread::sleep_for(std::chrono::milliseconds{1});
        files.add({});
        files.flush();
    }
    EXPECT_NE(files.fault().find("was deleted during the run"), std::string::npos) << files.fault();
    end(files);
}

}  // namespace
}  // namespace thimble
