#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <utility>

#include "apps/view/server_context.h"
#include "apps/view/socket.h"
#include "base/error.h"

namespace kdray::view {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;

constexpr std::uint32_t kMostHead = 8192;
constexpr std::uint64_t kMostBody = 256;

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}
beast::string_view beast_view(std::string_view text) {
  return {text.data(), text.size()};
}

// Of several fields of one name the first; two Hosts are refused.
Request request_of(const http::request<http::string_body>& message) {
  const auto field = [&](http::field name) { return view_of(message[name]); };
  Request request{view_of(message.method_string()), view_of(message.target()),  field(http::field::host),
                  field(http::field::origin),       field(http::field::cookie), message.body()};
  if (message.count(http::field::host) != 1) request.host = {};
  if (message.count(http::field::origin) > 1) request.host = {};
  return request;
}

// A connection that is no WebSocket (yet).
class Connection : public PendingConnection, public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, ServerContext& context) : stream_(std::move(socket)), context_(context) {}
  ~Connection() override {
    if (listed_) context_.pending.erase(place_);
  }

  void start() {
    place_ = context_.pending.insert(context_.pending.end(), weak_from_this());
    listed_ = true;
    read();
  }
  void close() override { beast::get_lowest_layer(stream_).close(); }

 private:
  void read();
  void handle(beast::error_code error);
  void reply(const Response& response);
  void written(bool keep, beast::error_code error);

  beast::tcp_stream stream_;
  ServerContext& context_;
  beast::flat_buffer buffer_{2 * kMostHead};
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  std::list<std::weak_ptr<PendingConnection>>::iterator place_;
  bool listed_ = false;
};

void Connection::read() {
  parser_.emplace();
  parser_->header_limit(kMostHead);
  parser_->body_limit(kMostBody);
  stream_.expires_after(context_.limits.request);
  http::async_read(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](beast::error_code error, std::size_t) { self->handle(error); });
}

void Connection::handle(beast::error_code error) {
  if (error) return;  // what can't be parsed gets no answer
  const auto& message = parser_->get();
  const Request request = request_of(message);
  if (!beast::websocket::is_upgrade(message)) return reply(answer(request, context_.access));
  if (!may_connect(request, context_.access))
    return reply({403, "text/plain", "this is for the page itself\n"});
  const bool known = knows_token(request, context_.access);
  stream_.expires_never();  // the WebSocket has a timer of its own
  open_socket(std::move(stream_), parser_->release(), known, context_);
}

void Connection::reply(const Response& response) {
  const auto& request = parser_->get();
  bool keep = request.keep_alive();
  response_ = {};
  response_.version(request.version());
  response_.result(static_cast<unsigned>(response.status));
  response_.set(http::field::content_type, beast_view(response.type));
  response_.set(http::field::cache_control, "no-store");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Cross-Origin-Resource-Policy", "same-origin");
  for (const auto& [name, value] : response.fields) {
    response_.set(beast_view(name), value);
    if (name == "Connection" && value == "close") keep = false;
  }
  response_.keep_alive(keep);
  if (request.method() != http::verb::head) response_.body() = response.body;
  response_.content_length(response.body.size());
  stream_.expires_after(context_.limits.request);
  http::async_write(stream_, response_,
                    [self = shared_from_this(), keep](beast::error_code error, std::size_t) {
                      self->written(keep, error);
                    });
}

void Connection::written(bool keep, beast::error_code error) {
  if (error) return;
  if (keep) return read();
  beast::error_code ignored;
  stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
}

}  // namespace

void serve(tcp::socket socket, ServerContext& context) {
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  if (context.pending.size() + context.n_pages >= context.limits.connections && !context.pending.empty())
    if (const auto oldest = context.pending.front().lock()) oldest->close();
  std::make_shared<Connection>(std::move(socket), context)->start();
}

}  // namespace kdray::view
