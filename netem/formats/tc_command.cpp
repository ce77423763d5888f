#include "netem/formats/tc_command.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostCharacters = 65536;

using Words = std::vector<std::string>;

[[noreturn]] void refuse(std::string_view why) { throw Error(ExitCode::kUsage, "tc words: {}", why); }

bool is_tc(std::string_view word) {
    return word == "tc" || word.ends_with("/tc") || word == "$TC" || word == "${TC}";
}

// The words of a command without its redirections (2>/dev/null, >out, > out).
Words words_without_redirections(std::string_view command) {
    Words words;
    bool target = false;
    for (const std::string_view word : words_of(command)) {
        const bool redirects = word.find('>') != std::string_view::npos && !word.starts_with('<');
        if (!redirects && !target) words.emplace_back(word);
        target = redirects && word.ends_with('>');
    }
    return words;
}

// Lines that end in a backslash go on. Quotes go, since no word of tc has a blank in it.
std::string joined(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\r' || text[i] == '"' || text[i] == '\'') continue;
        const std::size_t next = text.find_first_not_of('\r', i + 1);
        if (text[i] == '\\' && next != std::string_view::npos && text[next] == '\n') {
            out += ' ';
            i = next;
        } else {
            out += text[i];
        }
    }
    return out;
}

std::string_view without_comment(std::string_view line) {
    for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
        if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
    }
    return line;
}

void split_line(std::string_view line, std::vector<Words>& commands) {
    while (!line.empty()) {
        std::size_t end = line.find_first_of(";|");
        end = std::min({end, line.find("&&"), line.size()});
        Words words = words_without_redirections(line.substr(0, end));
        if (!words.empty()) commands.push_back(std::move(words));
        const std::size_t next = line.find_first_not_of(";|&", end);
        line = next == std::string_view::npos ? std::string_view() : line.substr(next);
    }
}

// A '#' before a command is a comment in a script, and root's prompt where every line has it.
std::vector<Words> commands_of(std::string_view text) {
    const std::string whole = joined(text);
    std::vector<std::string_view> lines;
    bool prompts = true;
    for (std::string_view rest = whole; !rest.empty();) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        if (const auto line = trimmed(rest.substr(0, end)); !line.empty()) {
            lines.push_back(line);
            prompts = prompts && line.front() == '#';
        }
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    std::vector<Words> commands;
    for (std::string_view line : lines) {
        if (prompts || line.starts_with("$ ")) line.remove_prefix(1);
        split_line(without_comment(trimmed(line)), commands);
    }
    return commands;
}

class TextReader {
  public:
    TcText read(std::string_view text) {
        if (text.size() > kMostCharacters) refuse(fmt::format("more than {} characters", kMostCharacters));
        if (looks_like_tc_commands(text)) {
            for (Words& words : commands_of(text)) take(std::move(words));
        } else {
            put({{}, "root", {}, {.words = words_alone(text)}});
        }
        if (places_.empty()) refuse_without_netem();
        if (strangers_ > 0)
            note(fmt::format("left out {} {} not part of tc", strangers_,
                             strangers_ == 1 ? "command that is" : "commands that are"));
        for (const std::string& kind : kinds_) note(fmt::format("{}; it is left out", about(kind)));
        gather();
        return std::move(result_);
    }

  private:
    struct Place {  // of a netem qdisc
        std::string device, parent, handle;
        TcQdisc qdisc;
    };
    // The words of a command after tc's object and verb, or of a line of tc's output.
    struct Qdisc {
        std::string device, parent, handle, kind;
        Words words;
    };

    void note(std::string text) { result_.notes.push_back(std::move(text)); }

    void take(Words words) {
        const auto tc = std::find_if(words.begin(), words.end(), is_tc);
        if (tc != words.end()) return command(words, static_cast<std::size_t>(tc - words.begin()));
        if (words[0] == "qdisc") return output_line(words);
        if (words[0] == "Sent" || words[0] == "backlog") return;  // statistics (tc -s)
        const auto netem = std::find(words.begin(), words.end(), "netem");
        if (netem == words.end()) return void(++strangers_);
        words.erase(words.begin(), netem + 1);
        put({{}, "root", {}, {.words = std::move(words)}});
    }
    static Words words_alone(std::string_view text) {
        std::string plain(text);
        std::replace_if(
            plain.begin(), plain.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        const auto words = words_of(plain);
        return {words.begin(), words.end()};
    }

    void command(const Words& words, std::size_t tc) {
        std::string where;
        for (std::size_t i = 0; i < tc; ++i) {
            if (words[i] != "sudo" && words[i] != "$SUDO" && !words[i].ends_with('#') &&
                !words[i].ends_with('$'))
                where += words[i] + ' ';
        }
        std::size_t at = tc + 1;
        for (; at < words.size() && words[at].starts_with('-'); ++at) {
            if (words[at].starts_with("-n") && at + 1 < words.size()) where += words[++at] + ' ';
        }
        const std::string object = at < words.size() ? words[at++] : "";
        if (!std::string_view("qdisc").starts_with(object) || object.empty()) {
            if (object == "class" || object == "filter") kinds_.insert(object);
            return;
        }
        const std::string verb = at < words.size() ? words[at++] : "show";
        Qdisc qdisc = parse({words.begin() + static_cast<std::ptrdiff_t>(at), words.end()});
        qdisc.device = where + qdisc.device;
        if (verb == "show" || verb == "list" || verb == "ls") {
            shows_ = true;
            shown_device_ = qdisc.device;
            return;
        }
        if (std::string_view("delete").starts_with(verb))
            return remove(qdisc, fmt::format("{}", fmt::join(words, " ")));
        if (qdisc.kind.empty()) return;
        if (qdisc.kind != "netem") return void(kinds_.insert(qdisc.kind));
        put({qdisc.device, qdisc.parent, qdisc.handle, {.words = std::move(qdisc.words)}});
    }

    // qdisc netem 8001: dev eth0 root refcnt 2 limit 1000 delay 50ms
    void output_line(const Words& words) {
        if (words.size() < 3) return;
        Qdisc qdisc = parse({words.begin() + 3, words.end()}, words[1]);
        if (qdisc.device.empty()) qdisc.device = shown_device_;
        if (qdisc.kind == "netem") {
            return put(
                {qdisc.device, qdisc.parent, words[2], {.words = std::move(qdisc.words), .shown = true}});
        }
        constexpr std::array<std::string_view, 9> kSystems{"noqueue", "mq",  "pfifo_fast", "fq_codel", "fq",
                                                           "pfifo",   "sfq", "ingress",    "clsact"};
        if (std::find(kSystems.begin(), kSystems.end(), qdisc.kind) == kSystems.end())
            kinds_.insert(qdisc.kind);
    }

    // Where a qdisc is comes before its kind, in any order; `kind` is known in tc's output.
    static Qdisc parse(const Words& words, std::string kind = {}) {
        Qdisc qdisc;
        qdisc.parent = "root";
        std::size_t at = 0;
        for (; at < words.size(); ++at) {
            const std::string& word = words[at];
            const bool has_value = word == "dev" || word == "parent" || word == "handle" || word == "refcnt";
            if (!has_value && word != "root") break;
            if (!has_value) continue;
            const std::string value = at + 1 < words.size() ? words[++at] : "";
            if (word == "dev") qdisc.device = value;
            if (word == "parent") qdisc.parent = value;
            if (word == "handle") qdisc.handle = value;
        }
        if (kind.empty() && at < words.size()) kind = words[at++];
        qdisc.kind = std::move(kind);
        qdisc.words.assign(words.begin() + static_cast<std::ptrdiff_t>(std::min(at, words.size())),
                           words.end());
        return qdisc;
    }

    void put(Place place) {
        place.qdisc.device = place.device;
        const auto known = std::find_if(places_.begin(), places_.end(), [&](const Place& other) {
            return other.device == place.device && other.parent == place.parent;
        });
        if (known == places_.end()) return places_.push_back(std::move(place));
        *known = std::move(place);
    }
    void remove(const Qdisc& qdisc, std::string command) {
        removed_ = std::move(command);
        std::erase_if(places_, [&](const Place& place) {
            return place.device == qdisc.device && (qdisc.parent == "root" || qdisc.parent == place.parent);
        });
    }

    static std::string about(const std::string& kind) {
        if (kind == "filter")
            return "filter sorts packets, which netem does not do: here every packet passes through netem";
        if (kind == "class") return "class belongs to a qdisc such as htb, not to netem";
        if (kind == "tbf" || kind == "htb" || kind == "cake" || kind == "hfsc")
            return kind + " limits the rate and is not netem's: netem's own word is `rate 10mbit`";
        return kind + " is a qdisc of its own and not netem's";
    }

    [[noreturn]] void refuse_without_netem() const {
        if (!removed_.empty()) {
            refuse(fmt::format(
                "'{}' removes a qdisc, and none is left to emulate; the profile \"ideal\" is a network "
                "that does nothing",
                removed_));
        }
        if (!kinds_.empty()) refuse(fmt::format("there is no \"netem\": {}", about(*kinds_.begin())));
        if (shows_) refuse("this command only shows qdiscs: paste its output");
        refuse("there is no \"netem\": only netem's words are read");
    }

    // One for each device. A netem inside another netem meets the same packets; any other second one does not.
    void gather() {
        for (Place& place : places_) {
            auto& all = result_.qdiscs;
            const auto known = std::find_if(
                all.begin(), all.end(), [&](const TcQdisc& qdisc) { return qdisc.device == place.device; });
            if (known == all.end()) {
                all.push_back(std::move(place.qdisc));
            } else if (is_inside_another(place)) {
                known->words.insert(known->words.end(), place.qdisc.words.begin(), place.qdisc.words.end());
                note(fmt::format("dev {}: a netem inside another is read as one with the words of both",
                                 place.device));
            } else {
                refuse(
                    fmt::format("dev {} has several netem qdiscs, for different packets (a filter sorts "
                                "them): write the words of one",
                                place.device));
            }
        }
    }
    bool is_inside_another(const Place& inner) const {
        const std::string major = inner.parent.substr(0, inner.parent.find(':'));
        return std::any_of(places_.begin(), places_.end(), [&](const Place& outer) {
            return outer.device == inner.device && !outer.handle.empty() &&
                   outer.handle.substr(0, outer.handle.find(':')) == major;
        });
    }

    TcText result_;
    std::vector<Place> places_;
    std::set<std::string> kinds_;  // other than netem
    std::string shown_device_;     // of the last `tc qdisc show`, whose output does not repeat it
    std::string removed_;          // the last command that removed a qdisc
    std::size_t strangers_ = 0;
    bool shows_ = false;
};

}  // namespace

bool TcQdisc::incoming() const {
    const std::size_t name = device.rfind(' ') + 1;  // 0 without a blank
    return device.compare(name, 3, "ifb") == 0;
}

TcText read_tc_text(std::string_view text) { return TextReader().read(text); }

bool looks_like_tc_commands(std::string_view text) {
    std::string plain(text);
    std::erase_if(plain, [](char c) { return c == '"' || c == '\''; });
    std::replace(plain.begin(), plain.end(), '\n', ' ');
    const auto words = words_of(plain);
    const auto netems = [](std::string_view word) { return word == "netem" || is_tc(word); };
    return words.size() > 1 && (words[0] == "qdisc" || std::any_of(words.begin(), words.end(), netems));
}

}  // namespace thimble
