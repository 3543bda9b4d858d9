// A WebSocket of a page that knows the token: the input's blocks are its messages, masked and framed as they
// should be; or, where the first byte is odd, all of it is frames.
#include "fuzz/view_server.h"

namespace {

std::string frame_of(std::string_view text) {
  constexpr char kFinalText = '\x81', kMasked = '\x80';
  std::string frame{kFinalText};
  if (text.size() < 126) {
    frame += static_cast<char>(kMasked | static_cast<char>(text.size()));
  } else {
    frame += static_cast<char>(kMasked | 126);
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size() & 255);
  }
  return frame.append(4, '\0').append(text);  // a mask of zeros
}

}  // namespace

KDRAY_FUZZ(websocket, bytes) {
  using namespace kdray;
  constexpr const char* kUpgrade =
      "GET /socket HTTP/1.1\r\nHost: 127.0.0.1:7878\r\nOrigin: http://127.0.0.1:7878\r\nCookie: "
      "kdray=TOKEN\r\n"
      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
  fuzz::Input input(bytes);
  const bool raw = input.take<std::uint8_t>() % 2 == 1;
  std::string frames;
  if (raw)
    frames = input.rest();
  else
    for (frames = frame_of(R"({"type":"hello","token":""})"); !input.is_at_end();)
      frames += frame_of(input.block());
  return fuzz::serve_bytes(kUpgrade, frames).n_received > 0;
}
