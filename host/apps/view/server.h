// What    The server of the page: HTTP and WebSockets on one address, by a single thread; and the two sides
//         of a WebSocket whose page knows the token: the page, to which messages are sent, and the handler of
//         what all pages send.
// Shape   A connection asks for files, one after the other, or becomes a WebSocket, whose page is a Client
//         once it has shown that it knows the token. Everything that a client can make grow has a limit.
// Errors  ErrorCode::input for an address that can't be listened on. Clients can't cause any: what they do
//         wrong ends their connection.
// Threads Any thread may send to a Client. The server's thread alone calls a ClientHandler, which releases
//         its clients before the server ends.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "apps/view/message.h"

namespace kdray::view {

using Bytes = std::shared_ptr<const std::string>;

class Client {
 public:
  virtual ~Client() = default;
  virtual void send(std::string text) = 0;
  virtual void send(Bytes frame) = 0;
};

class ClientHandler {
 public:
  virtual ~ClientHandler() = default;
  virtual void connected(const std::shared_ptr<Client>& client) = 0;
  virtual void received(const Client& client, const Message& message) = 0;
  virtual void disconnected(const Client& client) = 0;
};

struct ServerOptions {
  std::string bind = "127.0.0.1";  // an address in numbers
  int port = 0;                    // 0: kUsualPort, or the next one that is free
  // Whether pages of other servers on this machine may show the page in a frame, as notebooks do.
  bool framed = false;
  // The server ends so long after the last page was closed; 0: it stays.
  std::chrono::milliseconds linger{0};
  // Called twice a second; true ends the server.
  std::function<bool()> is_over = {};
};

inline constexpr int kUsualPort = 7878;

// The most that a client may use.
struct Limits {
  std::size_t connections = 64;  // beyond them the oldest one that is no page is closed
  std::size_t pages = 16;
  std::size_t queued_messages = 64, queued_bytes = std::size_t{64} << 20;  // to one that doesn't read
  std::chrono::seconds request{10};  // for a whole request, and between two
  std::chrono::seconds silence{20};  // of a WebSocket, that doesn't even answer pings
};

class Server {
 public:
  explicit Server(const ServerOptions& options, const Limits& limits = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  // Returns the address for the browser, with the token.
  std::string address() const;

  // Serves until stop(), or as the options say. To be called once.
  void run(ClientHandler& handler);
  void stop();  // from any thread

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kdray::view
