// An order in a participant session does what the typed line does.
#include "session/play/order_lines.hpp"

#include <gtest/gtest.h>

#include "session/participant/prompt.hpp"

namespace thimble {
namespace {

class OrderLinesTest : public testing::Test {
  protected:
    std::optional<Refusal> say(OrderKind kind) {
        Order order;
        order.kind = kind;
        return lines.obey({}, order);
    }
    PromptKind next() {
        const auto line = lines.take_line();
        EXPECT_TRUE(line);
        return line ? parse_prompt_line(*line).kind : PromptKind::kUnknown;
    }
    OrderLines lines;
};

TEST_F(OrderLinesTest, EachOrderIsTheLineThatSomebodyCouldType) {
    say(OrderKind::kRepeat);
    say(OrderKind::kExclude);
    say(OrderKind::kQuit);
    EXPECT_EQ(next(), PromptKind::kReject);
    EXPECT_EQ(next(), PromptKind::kExclude);
    EXPECT_EQ(next(), PromptKind::kQuit);
    EXPECT_FALSE(lines.take_line());
    EXPECT_FALSE(lines.ended());
}

TEST_F(OrderLinesTest, GoOnSaidManyTimesIsOneLine) {
    for (int i = 0; i < 7; ++i) say(OrderKind::kStart);
    EXPECT_EQ(next(), PromptKind::kGoOn);
    EXPECT_FALSE(lines.take_line());
}

TEST_F(OrderLinesTest, PauseTakesAGoOnBackAndResumeIsOne) {
    say(OrderKind::kStart);
    say(OrderKind::kPause);
    EXPECT_TRUE(lines.context().paused);
    EXPECT_FALSE(lines.take_line());
    say(OrderKind::kResume);
    EXPECT_FALSE(lines.context().paused);
    EXPECT_EQ(next(), PromptKind::kGoOn);
}

TEST_F(OrderLinesTest, ConditionsAreNotTheExperimentersToChange) {
    for (const OrderKind kind :
         {OrderKind::kDelay, OrderKind::kNetwork, OrderKind::kEndTrial, OrderKind::kSeek, OrderKind::kSpeed})
        EXPECT_EQ(say(kind), Refusal::kUnexpectedKind);
    EXPECT_FALSE(lines.take_line());
}

TEST(QuitHandler, KnowsQuitAlone) {
    QuitHandler handler;
    Order order;
    order.kind = OrderKind::kDelay;
    EXPECT_EQ(handler.obey({}, order), Refusal::kUnexpectedKind);
    EXPECT_FALSE(handler.quit());
    order.kind = OrderKind::kQuit;
    EXPECT_EQ(handler.obey({}, order), std::nullopt);
    EXPECT_TRUE(handler.quit());
}

}  // namespace
}  // namespace thimble
