// What    The two sides of a WebSocket whose page knows the token: the page as it is talked to, and who
//         listens to all of them.
// Threads A Visitor may be talked to from any; a Reception is called by the server's thread alone,
//         and lets go of its visitors before the server goes.
#pragma once

#include <memory>
#include <string>

#include "apps/view/frame.h"
#include "apps/view/message.h"

namespace kdray::view {

class Visitor {
 public:
  virtual ~Visitor() = default;
  virtual void send(std::string text) = 0;
  virtual void send(Bytes frame) = 0;
};

class Reception {
 public:
  virtual ~Reception() = default;
  virtual void enter(const std::shared_ptr<Visitor>& visitor) = 0;
  virtual void hear(const Visitor& visitor, const Message& message) = 0;
  virtual void leave(const Visitor& visitor) = 0;
};

}  // namespace kdray::view
