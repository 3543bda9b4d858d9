// What    A connection to the page's server: plain requests, one after the other, which http.h answers, until
//         one of them makes it a WebSocket.
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/view/message.h"
#include "apps/view/server_context.h"
#include "base/error.h"

namespace kdray::view {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;

// Codes of closing that are the page's and ours.
constexpr std::uint16_t kNoToken = 4003, kFull = 4008, kWrong = 1008;

// A WebSocket of the page: refuses clients that don't know the token, passes the page's messages on to the
// handler, and sends the page what it is to show. The first message is hello, with the token where no cookie
// has it. What is sent waits in a queue, one write at a time; a client that doesn't read is disconnected as
// soon as the queue is full.
class Socket : public Client, public PendingConnection, public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream&& stream, bool known, ServerContext& context)
      : socket_(std::move(stream)), hello_timer_(socket_.get_executor()), known_(known), context_(context) {}
  ~Socket() override { unlist(); }

  void start(const http::request<http::string_body>& request);
  void close() override { beast::get_lowest_layer(socket_).close(); }
  void send(std::string text) override { post({std::make_shared<const std::string>(std::move(text)), true}); }
  void send(Bytes frame) override { post({std::move(frame), false}); }

 private:
  struct Sent {
    Bytes bytes;
    bool text = true;
  };

  void read();
  void handle(beast::error_code error);
  void hello(std::string_view text);
  void post(Sent sent);
  void queue(Sent sent);
  void write();
  void end(std::uint16_t code, const std::string& why);
  void disconnected();
  void unlist();

  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer hello_timer_;
  const bool known_;
  ServerContext& context_;
  beast::flat_buffer buffer_{2 * kMostText};
  std::deque<Sent> queue_;
  std::size_t queued_bytes_ = 0;
  bool is_page_ = false, ended_ = false, listed_ = false;
  std::list<std::weak_ptr<PendingConnection>>::iterator place_;
};

void Socket::unlist() {
  if (listed_) context_.pending.erase(place_);
  listed_ = false;
}

void Socket::start(const http::request<http::string_body>& request) {
  place_ = context_.pending.insert(context_.pending.end(),
                                   std::static_pointer_cast<PendingConnection>(shared_from_this()));
  listed_ = true;
  socket_.set_option(websocket::stream_base::timeout{context_.limits.request, context_.limits.silence, true});
  socket_.read_message_max(kMostText);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (!error) self->read();
  });
  // The timer of the stream counts pongs, which are no hello.
  hello_timer_.expires_after(context_.limits.request);
  hello_timer_.async_wait([weak = weak_from_this()](beast::error_code error) {
    const auto self = weak.lock();
    if (!error && self && !self->is_page_) self->close();
  });
}

void Socket::read() {
  socket_.async_read(
      buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) { self->handle(error); });
}

void Socket::handle(beast::error_code error) {
  if (error) return disconnected();
  if (ended_) return;
  try {
    if (!socket_.got_text()) throw Error(ErrorCode::input, "messages are texts");
    const auto data = buffer_.cdata();
    const std::string_view text(static_cast<const char*>(data.data()), data.size());
    is_page_ ? context_.handler->received(*this, parse_message(text)) : hello(text);
  } catch (const std::exception& wrong) {
    return end(kWrong, wrong.what());
  }
  buffer_.consume(buffer_.size());
  if (!ended_) read();
}

void Socket::hello(std::string_view text) {
  if (!context_.access.token.is(token_of_hello(text)) && !known_) return end(kNoToken, "no token");
  if (context_.n_pages >= context_.limits.pages) return end(kFull, "too many pages are open");
  is_page_ = true;
  hello_timer_.cancel();
  unlist();
  ++context_.n_pages;
  context_.pages_changed();
  context_.handler->connected(shared_from_this());
}

// May be called from any thread.
void Socket::post(Sent sent) {
  asio::post(socket_.get_executor(), [weak = weak_from_this(), sent = std::move(sent)]() mutable {
    if (const auto self = weak.lock()) self->queue(std::move(sent));
  });
}

void Socket::queue(Sent sent) {
  if (ended_) return;
  queued_bytes_ += sent.bytes->size();
  queue_.push_back(std::move(sent));
  // Without a close frame: the client doesn't read.
  if (queue_.size() > context_.limits.queued_messages || queued_bytes_ > context_.limits.queued_bytes) {
    disconnected();
    return close();
  }
  if (queue_.size() == 1) write();
}

void Socket::write() {
  const Sent& sent = queue_.front();
  socket_.text(sent.text);
  socket_.async_write(asio::buffer(*sent.bytes),
                      [self = shared_from_this(), bytes = sent.bytes](beast::error_code error, std::size_t) {
                        if (error || self->ended_) return;
                        self->queued_bytes_ -= bytes->size();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->write();
                      });
}

// Ends the connection. The close frame goes out only where nothing else is being written.
void Socket::end(std::uint16_t code, const std::string& why) {
  const bool writing = !queue_.empty();
  disconnected();
  if (writing) return close();
  constexpr std::size_t kMostReason = 120;
  websocket::close_reason reason(code);
  reason.reason = why.substr(0, kMostReason);
  socket_.async_close(reason, [self = shared_from_this()](beast::error_code) {});
}

void Socket::disconnected() {
  if (ended_) return;
  ended_ = true;
  hello_timer_.cancel();
  if (!is_page_) return;
  --context_.n_pages;
  context_.pages_changed();
  context_.handler->disconnected(*this);
}

void open_socket(beast::tcp_stream&& stream, http::request<http::string_body>&& request, bool knows_token,
                 ServerContext& context) {
  std::make_shared<Socket>(std::move(stream), knows_token, context)->start(request);
}

constexpr std::uint32_t kMostHead = 8192;
constexpr std::uint64_t kMostBody = 256;

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}
beast::string_view beast_view(std::string_view text) {
  return {text.data(), text.size()};
}

// Of several fields with one name the first counts; two Hosts are refused.
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
