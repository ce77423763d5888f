#include "netem/formats/tc_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <set>
#include <span>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/tc_command.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostPackets = 1'000'000;  // as many as a link may be told to hold
constexpr Duration kMicrosecond = std::chrono::microseconds{1};
constexpr Duration kLongestDelay = std::chrono::seconds{60};

class TcParser {
  public:
    TcParser(const TcQdisc& qdisc, const TableFinder& find_table)
        : words_(qdisc.words.begin(), qdisc.words.end()), shown_(qdisc.shown), find_table_(find_table) {}

    TcLink parse() {
        while (at_ < words_.size()) parse_option();
        finish();
        return std::move(result_);
    }

    struct Option {
        std::string_view name;
        void (*read)(TcParser& parser);
    };
    // The first that begins with the word is meant.
    static const Option* find(std::string_view word) {
        for (const Option& option : options()) {
            if (option.name.starts_with(word)) return &option;
        }
        return nullptr;
    }

  private:
    static std::span<const Option> options();  // in the order in which tc looks for them

    void parse_option() {
        const Option* option = find(words_[at_]);
        if (option == nullptr) {
            fail_word(
                "is not one of limit, delay, distribution, loss, ecn, duplicate, corrupt, reorder, gap, "
                "rate, slot, seed, ordered, unordered, both");
        }
        option_ = option->name == "latency" ? "delay" : option->name == "drop" ? "loss" : option->name;
        if (!seen_.insert(option_).second) fail_word("appears twice");
        ++at_;
        option->read(*this);
    }

    [[noreturn]] void fail(std::string_view why) const { throw Error(ExitCode::kUsage, "tc words: {}", why); }
    [[noreturn]] void fail_word(std::string_view why) const {
        if (at_ < words_.size() && words_[at_].find('$') != std::string_view::npos)
            why = "is a shell variable: write its value";
        if (at_ < words_.size()) fail(fmt::format("word {}, '{}', {}", at_ + 1, words_[at_], why));
        fail(fmt::format("after '{}': {}", option_, why));
    }
    bool number_is_next() const {
        return at_ < words_.size() && std::isdigit(static_cast<unsigned char>(words_[at_][0])) != 0;
    }

    // Takes the next word if `parse` understands it; `kind` says what it must be.
    template <class Parse>
    auto take(std::string_view kind, const Parse& parse) {
        const auto value = at_ < words_.size() ? parse(words_[at_]) : decltype(parse(""))();
        if (!value) fail_word(fmt::format("must be {}", kind));
        ++at_;
        return *value;
    }
    double take_share() { return take("a share such as 0.5%, from 0% to 100%", parse_tc_share); }
    Duration take_time(Duration bare) {
        return take("a time such as 50ms, up to 60 s", [bare](std::string_view word) {
            const auto time = parse_tc_time(word, bare);
            return time && *time <= kLongestDelay ? time : std::nullopt;
        });
    }
    std::size_t take_count(std::string_view kind, std::size_t least, std::size_t most) {
        return take(fmt::format("{} from {} to {}", kind, least, most), [&](std::string_view word) {
            const auto count = parse_tc_size(word);
            return count && *count >= least && *count <= most ? count : std::nullopt;
        });
    }
    double take_share_if_any(double otherwise) { return number_is_next() ? take_share() : otherwise; }
    void note(std::string text) { result_.notes.push_back(std::move(text)); }

    // Fates of single packets are independent here; the share is what was asked either way.
    void drop_correlation(std::string_view what) {
        const double correlation = take_share_if_any(0);
        if (correlation > 0) {
            note(
                fmt::format("{}: the correlation of {} is left out; each packet's fate is independent here, "
                            "and tc's correlation would change the share as well",
                            what, print_tc_share(correlation)));
        }
    }

    // `tc qdisc show` names its numbers ("p 1% r 10%").
    void skip_name(std::string_view name) {
        if (at_ < words_.size() && words_[at_] == name) ++at_;
    }
    double take_named_share(std::string_view name) {
        skip_name(name);
        return take_share();
    }
    double take_named_share_if_any(std::string_view name, double otherwise) {
        skip_name(name);
        return take_share_if_any(otherwise);
    }

    void delay() {
        link().delay = take_time(kMicrosecond);
        if (!number_is_next()) return;
        link().jitter.spread = take_time(kMicrosecond);
        if (link().jitter.spread > Duration::zero()) link().jitter.shape = JitterShape::kUniform;
        if (shown_)
            note(
                "delay: tc's output has no distribution, so uniform is assumed; add the word if it was "
                "another one");
        if (!number_is_next()) return;
        link().jitter.correlation = take("a correlation such as 25%, below 100%", [](std::string_view word) {
            const auto share = parse_tc_share(word);
            return share && *share < 1 ? share : std::nullopt;
        });
    }
    void distribution() { shape_ = take_shape(table_); }
    JitterShape take_shape(std::shared_ptr<const JitterTable>& table) {
        if (at_ == words_.size() || number_is_next())
            fail_word("must be uniform, normal, pareto, paretonormal or a table's name");
        const std::string_view name = words_[at_++];
        if (name == "paretonormal") return JitterShape::kParetoNormal;
        for (const JitterShape shape : {JitterShape::kUniform, JitterShape::kNormal, JitterShape::kPareto}) {
            if (name == to_string(shape)) return shape;
        }
        table = find_table_(name);
        return JitterShape::kTable;
    }

    void loss() {
        const std::string_view model = at_ < words_.size() ? words_[at_] : "";
        if (model == "state" || model == "gemodel" || model == "random") ++at_;
        if (model == "state") return four_state();
        if (model == "gemodel") return gilbert_elliott();
        const double share = take_share();
        const double correlation = take_share_if_any(0);
        link().loss = LossSettings::independent(share);
        if (correlation > 0 && share > 0) correlate_loss(share, correlation);
    }
    // tc's correlated loss misses its share and is deprecated. A chain that is lost in one state and received in the
    // other has share p / (p + r) and correlation 1 - p - r from packet to packet.
    void correlate_loss(double share, double correlation) {
        LossSettings& loss = link().loss;
        loss = {};
        loss.shape = LossShape::kGilbertElliott;
        loss.good_to_bad = share * (1 - correlation);
        loss.bad_to_good = (1 - share) * (1 - correlation);
        if (correlation == 1) fail("loss: a correlation of 100% would lose all or nothing");
        note(fmt::format(
            "loss: a correlation of {} is a Gilbert model here, so that {} of the packets are lost "
            "(tc loses fewer)",
            print_tc_share(correlation), print_tc_share(share)));
    }
    void gilbert_elliott() {
        LossSettings& loss = link().loss;
        loss.shape = LossShape::kGilbertElliott;
        loss.good_to_bad = take_named_share("p");
        loss.bad_to_good = take_named_share_if_any("r", 1 - loss.good_to_bad);
        loss.loss_in_bad = take_named_share_if_any("1-h", 1);
        loss.loss_in_good = take_named_share_if_any("1-k", 0);
        if (loss.good_to_bad + loss.bad_to_good == 0) {
            fail("loss gemodel: p and r are both 0%, so the chain never moves; say loss random");
        }
    }
    void four_state() {
        LossSettings& loss = link().loss;
        loss.shape = LossShape::kFourState;
        loss.p13 = take_named_share("p13");
        loss.p31 = take_named_share_if_any("p31", 1 - loss.p13);
        loss.p32 = take_named_share_if_any("p32", 0);
        loss.p23 = take_named_share_if_any("p23", 1);
        loss.p14 = take_named_share_if_any("p14", 0);
        if (loss.p13 + loss.p14 > 1) fail("loss state: p13 + p14 is above 100%");
        if (loss.p31 + loss.p32 > 1) fail("loss state: p31 + p32 is above 100%");
        if (loss.p31 == 0) fail("loss state: p31 is 0%, so a burst would never end");
        if (loss.p23 == 0) fail("loss state: p23 is 0%, so state 2 would never end");
    }

    void share_of(double& value) {
        value = take_share();
        drop_correlation(option_);
    }

    void rate() {
        link().rate.bits_per_s = take("a rate such as 10mbit, from 1bit to 1tbit", [](std::string_view word) {
            const auto rate = parse_tc_rate(word);
            return rate && *rate >= 1 ? rate : std::nullopt;
        });
        RateSettings& rate = link().rate;
        rate.overhead_bytes = take_bytes("packetoverhead", "an overhead in bytes");
        rate.cell_bytes = take_bytes("cellsize", "a cell size in bytes");
        rate.cell_overhead_bytes = take_bytes("celloverhead", "a cell overhead in bytes");
        if (rate.cell_bytes == 0) rate.cell_overhead_bytes = 0;
    }
    std::size_t take_bytes(std::string_view name, std::string_view kind) {
        skip_name(name);
        if (at_ < words_.size() && words_[at_][0] == '-')
            fail_word("is a negative overhead: a relay sees payloads only and cannot remove headers");
        return number_is_next() ? take_count(kind, 0, 65535) : 0;
    }
    void slot() {
        SlotSettings& slot = link().slot;
        if (take_word("distribution")) {
            slot.shape = take_shape(slot.table);
            const Duration mean = take_time(Duration{1}), spread = take_time(Duration{1});
            slot.least = mean - spread;
            slot.most = mean + spread;
        } else {
            slot.least = slot.most = take_time(Duration{1});
            if (number_is_next()) slot.most = take_time(Duration{1});
        }
        if (slot.most < slot.least) fail("slot: the second time must be the longer one");
        if (slot.most == Duration::zero()) fail("slot: slots of length 0 have no effect; remove the word");
        if (take_word("packets")) slot.packets = take_count("a number of packets", 0, kMostPackets);
        if (take_word("bytes")) slot.bytes = take_count("a number of bytes", 0, 4294967295);
    }
    void seed() {
        result_.seed =
            take("a whole number", [](std::string_view word) { return parse_whole<std::uint64_t>(word); });
    }
    bool take_word(std::string_view name) {
        if (at_ == words_.size() || !name.starts_with(words_[at_])) return false;
        ++at_;
        return true;
    }

    void finish() {
        JitterSettings& jitter = link().jitter;
        if (shape_) {
            if (link().delay == Duration::zero() || jitter.spread == Duration::zero()) {
                fail("distribution needs a delay and a jitter, \"delay 50ms 10ms\"");
            }
            jitter.shape = *shape_;
            jitter.table = table_;
        }
        if (jitter.shape == JitterShape::kNone) jitter.correlation = 0;
        if (link().reorder > 0) {
            if (link().delay == Duration::zero()) fail("reorder needs a delay, which some packets then skip");
            link().reorder_gap = static_cast<unsigned>(std::max<std::size_t>(1, gap_.value_or(1)));
            link().in_order = false;
        } else if (gap_.value_or(0) > 0) {
            fail("gap says how often packets are reordered: give reorder, too");
        }
        if (link().ecn && link().loss.shape == LossShape::kNone)
            fail("ecn marks packets instead of losing them: give a loss, too");
        // The kernel queues by the time of leaving. With a rate no packet leaves before the one in front of it.
        const bool overtakes = jitter.shape != JitterShape::kNone && link().rate.bits_per_s == 0;
        if (ordered_) {
            if (*ordered_ && link().reorder > 0) fail("ordered contradicts reorder");
            link().in_order = *ordered_;
        } else if (overtakes) {
            link().in_order = false;
        }
        if (seen_.count("limit") == 0) make_room_for_delay(link());  // as in a session file
        if (jitter.spread > link().delay) {
            note(
                "delay: the jitter is larger than the delay, and no delay is below 0: the mean is then "
                "larger than requested");
        }
    }

    LinkSettings& link() { return result_.link; }

    std::vector<std::string_view> words_;
    bool shown_;  // by tc
    const TableFinder& find_table_;
    std::size_t at_ = 0;
    std::string_view option_ = "netem";
    std::set<std::string_view> seen_;
    TcLink result_;
    std::optional<JitterShape> shape_;
    std::shared_ptr<const JitterTable> table_;
    std::optional<std::size_t> gap_;
    std::optional<bool> ordered_;
};

std::span<const TcParser::Option> TcParser::options() {
    static constexpr std::array<Option, 17> kOptions{{
        {"limit",
         [](TcParser& p) { p.link().capacity = p.take_count("a number of packets", 1, kMostPackets); }},
        {"latency", [](TcParser& p) { p.delay(); }},
        {"delay", [](TcParser& p) { p.delay(); }},
        {"loss", [](TcParser& p) { p.loss(); }},
        {"drop", [](TcParser& p) { p.loss(); }},
        {"seed", [](TcParser& p) { p.seed(); }},
        {"ecn", [](TcParser& p) { p.link().ecn = true; }},
        {"reorder", [](TcParser& p) { p.share_of(p.link().reorder); }},
        {"corrupt", [](TcParser& p) { p.share_of(p.link().corrupt); }},
        {"gap", [](TcParser& p) { p.gap_ = p.take_count("a number of packets", 0, kMostPackets); }},
        {"duplicate", [](TcParser& p) { p.share_of(p.link().duplicate); }},
        {"distribution", [](TcParser& p) { p.distribution(); }},
        {"rate", [](TcParser& p) { p.rate(); }},
        {"slot", [](TcParser& p) { p.slot(); }},
        {"unordered", [](TcParser& p) { p.ordered_ = false; }},
        {"ordered", [](TcParser& p) { p.ordered_ = true; }},
        {"both", [](TcParser& p) { p.result_.both = true; }},
    }};
    return kOptions;
}

}  // namespace

TcLink parse_netem_words(const TcQdisc& qdisc, const TableFinder& find_table) {
    return TcParser(qdisc, find_table).parse();
}

bool looks_like_tc_words(std::string_view text) {
    if (looks_like_tc_commands(text)) return true;
    const std::vector<std::string_view> words = words_of(text);
    return words.size() > 1 && TcParser::find(words[0]) != nullptr;
}

}  // namespace thimble
