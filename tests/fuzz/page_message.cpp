#include "apps/view/message.h"

#include "fuzz/target.h"

KDRAY_FUZZ(page_message, bytes) {
  using namespace kdray;
  const bool hello = fuzz::is_read([&] { view::token_of_hello(bytes); });
  const bool other = fuzz::is_read([&] {
    const view::Message message = view::parse_message(bytes);
    if (const auto* const look = std::get_if<view::Look>(&message))
      if (look->request.width * look->request.height > view::kMostPixels)
        fuzz::fail("a picture that is too large");
  });
  return hello || other;
}
