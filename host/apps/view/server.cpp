#include "apps/view/server.h"

#include <fmt/format.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "apps/view/server_context.h"
#include "base/error.h"

namespace kdray::view {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Failure = boost::system::error_code;
using namespace std::chrono_literals;

constexpr int kPortsTried = 40;
constexpr auto kPollEvery = 500ms, kPause = 100ms;
constexpr std::size_t kCookieLetters = 8;

asio::ip::address address_of(const std::string& text) {
  Failure failure;
  const asio::ip::address address = asio::ip::make_address(text, failure);
  if (failure)
    throw Error(ErrorCode::usage,
                fmt::format("--bind '{}': expected an address in numbers, as 127.0.0.1 or ::1", text));
  return address;
}

}  // namespace

struct Server::Impl {
  Impl(const ServerOptions& options, const Limits& limits);

  void listen(const asio::ip::address& address, int port, Failure& failure);
  void accept();
  void pages_changed();
  void poll();

  ServerOptions options;
  ServerContext context;
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer pause{io}, polling{io}, lingering{io};
};

Server::Impl::Impl(const ServerOptions& o, const Limits& limits)
    : options(o), context{{Names(o.bind), Token(), {}, o.framed}, limits, nullptr, {}, 0, {}} {
  context.access.cookie = "kdray-" + Token().text().substr(0, kCookieLetters);
  context.pages_changed = [this] { pages_changed(); };
  const asio::ip::address address = address_of(o.bind);
  Failure failure;
  const int first = o.port > 0 ? o.port : kUsualPort, tries = o.port > 0 ? 1 : kPortsTried;
  for (int i = 0; i < tries; ++i) {
    listen(address, first + i, failure);
    if (!failure) return;
  }
  throw Error(ErrorCode::input, fmt::format("can't listen at {}:{} ({}); give another --port",
                                            in_brackets(o.bind), first, failure.message()));
}

void Server::Impl::listen(const asio::ip::address& address, int port, Failure& failure) {
  const tcp::endpoint place(address, static_cast<std::uint16_t>(port));
  Failure ignored;
  acceptor.close(ignored);
  acceptor.open(place.protocol(), failure);
  if (failure) return;
  acceptor.set_option(tcp::acceptor::reuse_address(true), ignored);
  acceptor.bind(place, failure);
  if (!failure) acceptor.listen(tcp::acceptor::max_listen_connections, failure);
}

void Server::Impl::accept() {
  acceptor.async_accept([this](Failure failure, tcp::socket socket) {
    if (failure == asio::error::operation_aborted) return;
    if (!failure) serve(std::move(socket), context);
    if (!failure) return accept();
    // For example out of descriptors: waits until other connections have been closed.
    pause.expires_after(kPause);
    pause.async_wait([this](Failure ended) {
      if (!ended) accept();
    });
  });
}

void Server::Impl::pages_changed() {
  lingering.cancel();
  if (context.n_pages > 0 || options.linger == 0ms) return;
  lingering.expires_after(options.linger);
  lingering.async_wait([this](Failure cancelled) {
    if (!cancelled) io.stop();
  });
}

void Server::Impl::poll() {
  if (!options.is_over) return;
  polling.expires_after(kPollEvery);
  polling.async_wait([this](Failure cancelled) {
    if (cancelled) return;
    options.is_over() ? io.stop() : poll();
  });
}

Server::Server(const ServerOptions& options, const Limits& limits)
    : impl_(std::make_unique<Impl>(options, limits)) {}
Server::~Server() = default;

int Server::port() const {
  return impl_->acceptor.local_endpoint().port();
}

std::string Server::address() const {
  const std::string& bound = impl_->options.bind;
  const std::string host = bound == "0.0.0.0" ? "127.0.0.1" : bound == "::" ? "[::1]" : in_brackets(bound);
  return fmt::format("http://{}:{}/#token={}", host, port(), impl_->context.access.token.text());
}

void Server::run(ClientHandler& handler) {
  impl_->context.handler = &handler;
  impl_->accept();
  impl_->poll();
  impl_->io.run();
}

void Server::stop() {
  impl_->io.stop();
}

}  // namespace kdray::view
