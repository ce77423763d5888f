#include "session/launch/remote_script.hpp"

#include <fmt/format.h>

#include "common/runtime/grant_stream.hpp"

namespace thimble {

// Within '...' a shell looks at nothing but the closing quote (POSIX.1-2017, Shell Command Language, 2.2.2).
std::string shell_word(std::string_view text) {
    std::string word = "'";
    for (const char c : text) {
        if (c == '\'') {
            word += "'\\''";
        } else {
            word += c;
        }
    }
    return word + "'";
}

std::string shell_words(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) {
        if (!line.empty()) line += ' ';
        line += shell_word(word);
    }
    return line;
}

namespace {

// One compound command: the shell has read all of it before it runs any of it, and so takes nothing of what follows
// for more script, however much it reads at once. Descriptor 3 is the launcher from then on.
constexpr const char* kBegin = R"sh({
umask 077
exec 3<&0 </dev/null
say() { printf 'thimble: %s\n' "$*" >&2; }
)sh";

constexpr const char* kLook = R"sh(
echo "$reached"
[ -z "$folder" ] || program=$folder/$program
if ! command -v "$program" >/dev/null 2>&1; then
    say "$program is not on '$machine': install Thimble there, or name its folder in [launch].programs"
    exit 96
fi
there=$("$program" --version 2>/dev/null) || there='one that cannot say its version'
if [ "$there" != "$version" ]; then
    say "$program on '$machine' is $there, but this is $version: install the same version on every machine"
    exit 97
fi
if [ -n "$only_check" ]; then echo "$good"; exit 0; fi
)sh";

// Without SIGPIPE: a launcher that is gone must not end this shell before it has cleaned up.
constexpr const char* kUnpack = R"sh(
trap '' PIPE
dir=$(mktemp -d "${TMPDIR:-/tmp}/thimble.XXXXXX") || { say "'$machine' has no room for a folder"; exit 98; }
trap 'rm -rf "$dir"' EXIT
trap 'exit 129' HUP INT TERM
echo "$send"
size=
while read -r size name <&3 && [ "$size" != end ]; do
    file=$dir/session/$name
    mkdir -p "${file%/*}"
    if [ "$size" -gt 0 ]; then dd bs="$size" count=1 iflag=fullblock of="$file" <&3 2>/dev/null; else : >"$file"; fi
    [ "$(wc -c <"$file")" -eq "$size" ] || { say "$name did not arrive whole on '$machine'"; exit 98; }
done
[ "$size" = end ] || exit 98
)sh";

// The node's parent is this shell, so --die-with-parent ends it even if this shell is killed. `keeper` then still
// removes the folder. `look` reads the centiseconds since the machine was started.
constexpr const char* kRun = R"sh(
look() { read -r up _ </proc/uptime && now=$((${up%.*} * 100 + 1${up#*.} - 100)); }
"$program" "$@" </dev/null >&2 3<&- &
node=$!
finish() {
    kill -TERM "$node" 2>/dev/null
    left=20
    while [ "$left" -gt 0 ] && kill -0 "$node" 2>/dev/null; do sleep 0.1; left=$((left - 1)); done
    kill -KILL "$node" 2>/dev/null
}
(
    while read -r _ <&3; do : >"$dir/alive"; done
    exec 3<&-
    finish
    while kill -0 "$$" 2>/dev/null; do sleep 0.1; done
    rm -rf "$dir"
) >/dev/null 2>&1 &
keeper=$!
exec 3<&-
(
    nap=
    trap 'kill "$nap"; exit 0' TERM
    look
    heard=$now
    while kill -0 "$node"; do
        sleep 0.4 &
        nap=$!
        wait "$nap"
        look
        [ ! -e "$dir/alive" ] || heard=$now
        rm -f "$dir/alive"
        [ "$((now - heard))" -lt "$lease_cs" ] || finish
    done
) >/dev/null 2>&1 &
lessor=$!
trap 'finish >/dev/null 2>&1 &' HUP INT TERM
wait "$node"
code=$?
while kill -0 "$node" 2>/dev/null; do
    wait "$node"
    code=$?
done
kill "$keeper" "$lessor" 2>/dev/null
echo "$report"
cat "$dir/report.json" 2>/dev/null
echo
set -- "$dir"/messages*.mcap
[ -f "$1" ] || set --
logs=
size=0
for file in "$@"; do
    bytes=$(($(wc -c <"$file")))
    size=$((size + bytes))
    case ${file##*/} in *_trial*)
        file=${file##*_trial}
        logs="$logs ${file%.mcap} $bytes"
    esac
done
echo "$ended $code$logs $size"
cat "$@"
exit "$code"
)sh";

std::string assign(std::string_view name, std::string_view value) {
    return fmt::format("{}={}\n", name, shell_word(value));
}

}  // namespace

std::string remote_script(const RemoteOrder& order) {
    std::string script = kBegin;
    script += assign("program", order.program) + assign("folder", order.folder) +
              assign("version", order.version) + assign("machine", order.machine) +
              assign("only_check", order.only_check ? "yes" : "") + assign("reached", kReached) +
              assign("send", kSend) + assign("report", kReport) + assign("good", kGood) +
              assign("ended", kEnded) +
              assign("lease_cs", fmt::format("{:.0f}", 100 * to_seconds(order.lease)));
    script += kLook;
    script += kUnpack;
    if (!order.grant_key.empty())
        script += assign(kGrantKeyVariable, order.grant_key) + fmt::format("export {}\n", kGrantKeyVariable);
    script += fmt::format(
        "messages=$dir/messages.mcap\nset -- \"$dir\"/session/{} --report \"$dir\"/report.json "
        "--die-with-parent=$$ {}{}\n",
        shell_word(order.session), order.messages ? "--log \"$messages\" " : "",
        shell_words(order.arguments));
    script += kRun;
    return script + "}\n";
}

}  // namespace thimble
