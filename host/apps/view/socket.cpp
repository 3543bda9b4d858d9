#include "apps/view/socket.h"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <string>
#include <utility>

#include "apps/view/message.h"
#include "base/error.h"

namespace kdray::view {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

// Codes of closing that are the page's and ours.
constexpr std::uint16_t kNoToken = 4003, kFull = 4008, kWrong = 1008;

class Socket : public Client, public PendingConnection, public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream&& stream, bool known, ServerContext& context)
      : socket_(std::move(stream)), hello_timer_(socket_.get_executor()), known_(known), context_(context) {}
  ~Socket() override { unlist(); }

  void start(const beast::http::request<beast::http::string_body>& request);
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

void Socket::start(const beast::http::request<beast::http::string_body>& request) {
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

// The close frame goes out only where nothing else is being written.
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

}  // namespace

void open_socket(beast::tcp_stream&& stream, beast::http::request<beast::http::string_body>&& request,
                 bool knows_token, ServerContext& context) {
  std::make_shared<Socket>(std::move(stream), knows_token, context)->start(request);
}

}  // namespace kdray::view
