// What    The two sides of a WebSocket whose page knows the token: the page, to which messages are sent, and
//         the handler of what all pages send.
// Threads Any thread may send to a Client. The server's thread alone calls a ClientHandler, which releases
//         its clients before the server ends.
#pragma once

#include <memory>
#include <string>

#include "apps/view/frame.h"
#include "apps/view/message.h"

namespace kdray::view {

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

}  // namespace kdray::view
