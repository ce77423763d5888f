// The experimenter's commands, and the length of a break.
#include "session/participant/prompt.hpp"

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "common/text_file.hpp"

namespace thimble {
namespace {

using std::chrono::seconds;

TEST(Prompt, Commands) {
    const auto kind = [](const char* line) { return parse_prompt_line(line).kind; };
    EXPECT_EQ(kind(""), PromptKind::kGoOn);
    EXPECT_EQ(kind("  \r"), PromptKind::kGoOn);
    EXPECT_EQ(kind("q"), PromptKind::kQuit);
    EXPECT_EQ(kind("r"), PromptKind::kNoReason);
    EXPECT_EQ(kind("x  "), PromptKind::kNoReason);
    EXPECT_EQ(kind("rx"), PromptKind::kUnknown);
    EXPECT_EQ(kind("quit"), PromptKind::kUnknown);
    EXPECT_EQ(kind("R sneezed"), PromptKind::kUnknown);
    EXPECT_EQ(kind("x sneezed"), PromptKind::kExclude);
    const PromptCommand reject = parse_prompt_line(" r  the\tphone rang \r");
    EXPECT_EQ(reject.kind, PromptKind::kReject);
    EXPECT_EQ(reject.reason, "the phone rang");
}

TEST(Prompt, ARestEndsByItselfOnlyWhereNobodyIsAsked) {
    const SessionTime begin{seconds{100}};
    const Rest alone(begin, seconds{30}, false);
    EXPECT_FALSE(alone.over_by_itself(begin + seconds{29}));
    EXPECT_TRUE(alone.over_by_itself(begin + seconds{30}));
    const Rest asked(begin, seconds{30}, true);
    EXPECT_FALSE(asked.over_by_itself(begin + seconds{300}));
    EXPECT_FALSE(asked.over_by_enter(begin + seconds{29}));
    EXPECT_TRUE(asked.over_by_enter(begin + seconds{30}));
    EXPECT_EQ(asked.left(begin + seconds{12}), seconds{18});
    EXPECT_EQ(asked.left(begin + seconds{31}), seconds{0});
}

class Pipe {
  public:
    Pipe() { EXPECT_EQ(::pipe(ends_.data()), 0); }
    ~Pipe() {
        ::close(ends_[0]);
        close();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    int reading_end() const { return ends_[0]; }
    void write(const std::string& text) {
        EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    }
    void close() {
        if (ends_[1] >= 0) ::close(ends_[1]);
        ends_[1] = -1;
    }

  private:
    std::array<int, 2> ends_{-1, -1};
};

TEST(DescriptorLines, LinesComeWhenTheyAreWhole) {
    Pipe pipe;
    DescriptorLines lines(pipe.reading_end());
    EXPECT_FALSE(lines.take_line().has_value());
    pipe.write("r sne");
    EXPECT_FALSE(lines.take_line().has_value());
    pipe.write("ezed\n\nx");
    EXPECT_EQ(lines.take_line(), "r sneezed");
    EXPECT_EQ(lines.take_line(), "");
    EXPECT_FALSE(lines.take_line().has_value());
    EXPECT_FALSE(lines.ended());
    pipe.close();
    EXPECT_EQ(lines.take_line(), "x");  // a last line without an end
    EXPECT_FALSE(lines.take_line().has_value());
    EXPECT_TRUE(lines.ended());
}

TEST(DescriptorLines, ATerminalForgetsEnterAndNoCommandAndAPipeForgetsNothing) {
    const FileDescriptor window(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    ASSERT_TRUE(::grantpt(window.get()) == 0 && ::unlockpt(window.get()) == 0) << "no pseudo-terminal";
    const char* const name = ::ptsname(window.get());  // NOLINT(concurrency-mt-unsafe): one thread
    const FileDescriptor terminal(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
    DescriptorLines typed(terminal.get());
    ASSERT_EQ(::write(window.get(), "\nr sneezed\n\n", 12), 12);
    int there = 0;  // the kernel hands the lines over one by one
    for (int i = 0; i < 1000 && there < 12 && ::ioctl(terminal.get(), FIONREAD, &there) == 0; ++i)
        ::poll(nullptr, 0, 10);
    ASSERT_EQ(there, 12);
    typed.forget_enter();
    EXPECT_EQ(typed.take_line(), "r sneezed");
    EXPECT_FALSE(typed.take_line().has_value());
    Pipe pipe;
    DescriptorLines script(pipe.reading_end());
    pipe.write("\n");
    script.forget_enter();
    EXPECT_EQ(script.take_line(), "");
}

// /dev/zero never pauses, as `yes ''` does not.
TEST(DescriptorLines, AnInputWithoutLinesEndsAndOneWithoutAPauseIsReadLineByLine) {
    const FileDescriptor zero(::open("/dev/zero", O_RDONLY | O_CLOEXEC));
    DescriptorLines zeros(zero.get());
    EXPECT_FALSE(zeros.take_line().has_value());
    EXPECT_TRUE(zeros.ended());
    Pipe pipe;
    DescriptorLines lines(pipe.reading_end());
    pipe.write(std::string(5000, '\n'));
    EXPECT_EQ(lines.take_line(), "");
    int left = 0;
    EXPECT_EQ(::ioctl(pipe.reading_end(), FIONREAD, &left), 0);
    EXPECT_GE(left, 3000);
}

}  // namespace
}  // namespace thimble
