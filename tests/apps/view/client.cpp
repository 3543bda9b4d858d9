#include "apps/view/client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>

namespace kdray::test {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Client::Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<sockaddr*>(&place), sizeof place) != 0)
    throw std::runtime_error("nobody listens");
}

Client::~Client() {
  ::close(socket_);
}

bool Client::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool Client::upgrade(const Head& head) {
  return send(test::upgrade(head)) && read_until("\r\n\r\n").starts_with("HTTP/1.1 101");
}

bool Client::wait(double seconds) const {
  pollfd polled{socket_, POLLIN, 0};
  return ::poll(&polled, 1, static_cast<int>(seconds * 1000)) > 0;
}

std::string Client::read_until(std::string_view text, double seconds) {
  std::string all;
  char block[65536];
  for (const double end = now() + seconds; all.find(text) == std::string::npos && now() < end;) {
    if (!wait(end - now())) break;
    const ssize_t n = ::recv(socket_, block, sizeof block, 0);
    if (n <= 0) break;
    all.append(block, static_cast<std::size_t>(n));
  }
  return all;
}

std::string Client::read_all(double seconds) {
  return read_until(std::string_view("\0no such text\0", 14), seconds);
}

bool Client::is_closed() {
  char block[65536];
  for (const double end = now() + kPatience; now() < end;) {
    if (!wait(end - now())) return false;
    if (::recv(socket_, block, sizeof block, 0) <= 0) return true;
  }
  return false;
}

std::string request(const std::string& method, const std::string& target, const Head& head,
                    const std::string& body) {
  std::string text = method + " " + target + " HTTP/1.1\r\n";
  if (!head.host.empty()) text += "Host: " + head.host + "\r\n";
  if (!head.origin.empty()) text += "Origin: " + head.origin + "\r\n";
  if (!head.cookie.empty()) text += "Cookie: " + head.cookie + "\r\n";
  text += head.more;
  if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return text + "\r\n" + body;
}

std::string upgrade(const Head& head, const std::string& target) {
  Head all = head;
  all.more +=
      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  return request("GET", target, all);
}

std::string ws_frame(std::string_view text, int opcode, bool masked) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  const int mask_bit = masked ? 0x80 : 0;
  if (text.size() < 126) {
    frame += static_cast<char>(mask_bit | static_cast<int>(text.size()));
  } else if (text.size() < 65536) {
    frame += static_cast<char>(mask_bit | 126);
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size() & 255);
  } else {
    frame += static_cast<char>(mask_bit | 127);
    for (int k = 7; k >= 0; --k) frame += static_cast<char>(text.size() >> (8 * k));
  }
  const char mask[4] = {0x12, 0x34, 0x56, 0x78};
  if (masked) frame.append(mask, 4);
  for (std::size_t i = 0; i < text.size(); ++i)
    frame += static_cast<char>(masked ? text[i] ^ mask[i % 4] : text[i]);
  return frame;
}

}  // namespace kdray::test
