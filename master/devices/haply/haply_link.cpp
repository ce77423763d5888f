#include "master/devices/haply/haply_link.hpp"

#include <array>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Failure = beast::error_code;

std::string refusal_of(std::uint16_t port, const Failure& failure) {
    return fmt::format(
        "no Haply Inverse Service at ws://localhost:{}: {}. Start it (the Haply Hub, or `sudo systemctl "
        "start haply-inverse-service`), or name its port in [handle.haply] port",
        port, failure.message());
}

}  // namespace

struct HaplyLink::Parts {
    asio::io_context context{1};
    beast::websocket::stream<beast::tcp_stream> stream{context};
    beast::flat_buffer buffer;
    std::string outgoing, trouble;
    bool reading = false, writing = false, received = false;

    // Runs what is under way until `done`, or the limit; without a wait at least what can end now.
    template <class Done>
    void run(Duration limit, Done done) {
        const SessionTime end = wall_now() + limit;
        context.restart();
        context.poll();
        while (!done()) {
            const Duration left = end - wall_now();
            if (context.stopped()) context.restart();
            if (left < Duration::zero() || context.run_one_for(left) == 0) return;
        }
    }
    void note(const Failure& failure) {
        if (failure && trouble.empty())
            trouble = "the connection to the service was closed: " + failure.message();
    }
    Failure connect(std::uint16_t port, Duration limit);
};

// A service that is bound to "localhost" may listen at either address.
Failure HaplyLink::Parts::connect(std::uint16_t port, Duration limit) {
    const std::array<asio::ip::tcp::endpoint, 2> places{
        {{asio::ip::address_v4::loopback(), port}, {asio::ip::address_v6::loopback(), port}}};
    Failure result = asio::error::timed_out, first;
    bool done = false;
    const auto shaken = [&](Failure failure) {
        result = failure;
        done = true;
    };
    const auto remember = [&](const Failure& failure, const asio::ip::tcp::endpoint& /*next*/) {
        if (!first) first = failure;
        return true;
    };
    stream.next_layer().async_connect(places, remember, [&](Failure failure, const auto& /*place*/) {
        if (failure) return shaken(first ? first : failure);
        stream.next_layer().socket().set_option(asio::ip::tcp::no_delay(true), failure);
        stream.async_handshake("localhost:" + std::to_string(port), "/", shaken);
    });
    run(limit, [&] { return done; });
    if (!done) {  // its handlers must not outlive this call
        stream.next_layer().cancel();
        run(limit, [&] { return done; });
        return asio::error::timed_out;
    }
    return result;
}

HaplyLink::HaplyLink(std::uint16_t port, Duration limit) : parts_(std::make_unique<Parts>()) {
    parts_->stream.read_message_max(kLongestMessage);
    if (const Failure failure = parts_->connect(port, limit))
        throw Error(ExitCode::kUsage, refusal_of(port, failure));
}

HaplyLink::~HaplyLink() = default;

const std::string& HaplyLink::trouble() const { return parts_->trouble; }

bool HaplyLink::send(std::string text) {
    Parts& p = *parts_;
    if (p.writing || !p.trouble.empty()) return false;
    p.writing = true;
    p.outgoing = std::move(text);
    p.stream.async_write(asio::buffer(p.outgoing), [&p](Failure failure, std::size_t /*bytes*/) {
        p.writing = false;
        p.note(failure);
    });
    p.context.restart();
    p.context.poll();
    return true;
}

std::optional<std::string> HaplyLink::receive(Duration limit) {
    Parts& p = *parts_;
    if (!p.reading && !p.received && p.trouble.empty()) {
        p.reading = true;
        p.stream.async_read(p.buffer, [&p](Failure failure, std::size_t /*bytes*/) {
            p.reading = false;
            p.received = !failure;
            p.note(failure);
        });
    }
    p.run(limit, [&p] { return p.received || !p.trouble.empty(); });
    if (!p.received) return std::nullopt;
    std::string text = beast::buffers_to_string(p.buffer.data());
    p.buffer.consume(p.buffer.size());
    p.received = false;
    return text;
}

void HaplyLink::close(Duration limit) {
    Parts& p = *parts_;
    if (!p.trouble.empty()) return;
    bool closed = false;
    p.stream.async_close(beast::websocket::close_code::normal,
                         [&closed](Failure /*failure*/) { closed = true; });
    p.run(limit, [&closed] { return closed; });
    p.trouble = "closed";
    if (closed) return;
    p.stream.next_layer().cancel();
    p.run(limit, [&closed] { return closed; });
}

}  // namespace thimble
