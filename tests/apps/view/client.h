// What    A client of the page's server that does just what a test says, well or ill: bytes out, bytes in,
//         over a plain socket, with the few lines of HTTP and WebSocket (RFC 6455) that it takes. Nothing of
//         it is the server's.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "support/patience.h"

namespace kdray::test {

class Client {
 public:
  explicit Client(int port);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // False: the other side has gone.
  bool send(std::string_view bytes);
  // All that comes until the other side closes, or for so long.
  std::string read_all(double seconds = kPatience);
  // Until `text` has come, too; what came.
  std::string read_until(std::string_view text, double seconds = kPatience);
  bool is_closed();  // by the other side, now or before patience ends
  // Asks for a WebSocket, and waits for the answer.
  bool upgrade(const struct Head& head);

 private:
  bool wait(double seconds) const;
  int socket_;
};

struct Head {
  std::string host = "127.0.0.1", origin = {}, cookie = {}, more = {};
};
std::string request(const std::string& method, const std::string& target, const Head& head,
                    const std::string& body = {});
std::string upgrade(const Head& head, const std::string& target = "/socket");

// A client's frame of a WebSocket: text by default.
std::string ws_frame(std::string_view text, int opcode = 1, bool masked = true);

}  // namespace kdray::test
