// What    A connection to the page's server whose bytes are an input's; it is closed behind them.
// Shape   The socket is one end of a pair in this process, so that all of it happens within serve_bytes(),
//         without a network or a wait. "TOKEN" in the bytes stands for the server's own.
#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "apps/view/server_context.h"
#include "fuzz/target.h"

namespace kdray::fuzz {

class Counting final : public view::ClientHandler {
 public:
  void connected(const std::shared_ptr<view::Client>& client) override { client->send("{}"); }
  void received(const view::Client&, const view::Message&) override { ++n_received; }
  void disconnected(const view::Client&) override {}
  std::size_t n_received = 0;
};

struct Served {
  std::string answer;
  std::size_t n_received = 0;  // messages of a page
};

// `then`: what is sent once the first bytes have been answered.
inline Served serve_bytes(std::string bytes, std::string_view then = {}) {
  static view::ServerContext context{{view::Names("127.0.0.1"), {}, "kdray"}, {}, nullptr, {}, 0, [] {}};
  for (std::size_t at = 0; (at = bytes.find("TOKEN", at)) != std::string::npos;)
    bytes.replace(at, 5, context.access.token.text());
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0)
    fail("no pair of sockets");
  Counting handler;
  context.handler = &handler;
  context.n_pages = 0;
  {
    boost::asio::io_context io(1);
    boost::asio::ip::tcp::socket socket(io);
    socket.assign(boost::asio::ip::tcp::v4(), ends[0]);
    view::serve(std::move(socket), context);
    for (const std::string_view part : {std::string_view(bytes), then}) {
      // What doesn't fit the socket's buffer is left out.
      [[maybe_unused]] const ssize_t sent = ::send(ends[1], part.data(), part.size(), MSG_NOSIGNAL);
      while (io.poll() > 0) continue;
    }
    ::shutdown(ends[1], SHUT_WR);
    while (io.poll() > 0) continue;
  }
  if (!context.pending.empty()) fail("a connection that outlives its socket");
  Served served{std::string(std::size_t{1} << 16, '\0'), handler.n_received};
  const ssize_t n = ::recv(ends[1], served.answer.data(), served.answer.size(), 0);
  served.answer.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  ::close(ends[1]);
  return served;
}

}  // namespace kdray::fuzz
