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

class Socket : public Visitor, public Guestless, public std::enable_shared_from_this<Socket> {
 public:
  Socket(beast::tcp_stream&& stream, bool known, House& house)
      : socket_(std::move(stream)), hello_timer_(socket_.get_executor()), known_(known), house_(house) {}
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
  void take(beast::error_code error);
  void hello(std::string_view text);
  void post(Sent sent);
  void queue(Sent sent);
  void write();
  void end(std::uint16_t code, const std::string& why);
  void left();
  void unlist();

  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer hello_timer_;
  const bool known_;
  House& house_;
  beast::flat_buffer buffer_{2 * kMostText};
  std::deque<Sent> queue_;
  std::size_t queued_bytes_ = 0;
  bool entered_ = false, ended_ = false, listed_ = false;
  std::list<std::weak_ptr<Guestless>>::iterator place_;
};

void Socket::unlist() {
  if (listed_) house_.waiting.erase(place_);
  listed_ = false;
}

void Socket::start(const beast::http::request<beast::http::string_body>& request) {
  place_ =
      house_.waiting.insert(house_.waiting.end(), std::static_pointer_cast<Guestless>(shared_from_this()));
  listed_ = true;
  socket_.set_option(websocket::stream_base::timeout{house_.limits.request, house_.limits.silence, true});
  socket_.read_message_max(kMostText);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (!error) self->read();
  });
  // Pongs don't say hello.
  hello_timer_.expires_after(house_.limits.request);
  hello_timer_.async_wait([weak = weak_from_this()](beast::error_code error) {
    const auto self = weak.lock();
    if (!error && self && !self->entered_) self->close();
  });
}

void Socket::read() {
  socket_.async_read(
      buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) { self->take(error); });
}

void Socket::take(beast::error_code error) {
  if (error) return left();
  if (ended_) return;
  try {
    if (!socket_.got_text()) throw Error(ErrorCode::input, "messages are texts");
    const auto data = buffer_.cdata();
    const std::string_view text(static_cast<const char*>(data.data()), data.size());
    entered_ ? house_.reception->hear(*this, parse_message(text)) : hello(text);
  } catch (const std::exception& wrong) {
    return end(kWrong, wrong.what());
  }
  buffer_.consume(buffer_.size());
  if (!ended_) read();
}

void Socket::hello(std::string_view text) {
  if (!house_.door.token.is(token_of_hello(text)) && !known_) return end(kNoToken, "no token");
  if (house_.n_pages >= house_.limits.pages) return end(kFull, "too many pages are open");
  entered_ = true;
  hello_timer_.cancel();
  unlist();
  ++house_.n_pages;
  house_.pages_changed();
  house_.reception->enter(shared_from_this());
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
  // No farewell: it doesn't read.
  if (queue_.size() > house_.limits.queued_messages || queued_bytes_ > house_.limits.queued_bytes) {
    left();
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

// The farewell goes out while nothing else is being written, or not at all.
void Socket::end(std::uint16_t code, const std::string& why) {
  const bool writing = !queue_.empty();
  left();
  if (writing) return close();
  constexpr std::size_t kMostReason = 120;
  websocket::close_reason reason(code);
  reason.reason = why.substr(0, kMostReason);
  socket_.async_close(reason, [self = shared_from_this()](beast::error_code) {});
}

void Socket::left() {
  if (ended_) return;
  ended_ = true;
  hello_timer_.cancel();
  if (!entered_) return;
  --house_.n_pages;
  house_.pages_changed();
  house_.reception->leave(*this);
}

}  // namespace

void open_socket(beast::tcp_stream&& stream, beast::http::request<beast::http::string_body>&& request,
                 bool knows_token, House& house) {
  std::make_shared<Socket>(std::move(stream), knows_token, house)->start(request);
}

}  // namespace kdray::view
