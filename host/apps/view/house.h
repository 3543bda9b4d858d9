// What    What all connections of a server share: its limits, who it lets in, and the list of those that are
//         there.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <list>
#include <memory>

#include "apps/view/http.h"
#include "apps/view/server.h"

namespace kdray::view {

// Before it is a page: of those that are there.
class Guestless {
 public:
  virtual ~Guestless() = default;
  virtual void close() = 0;
};

struct House {
  Door door;
  Limits limits;
  Reception* reception = nullptr;
  std::list<std::weak_ptr<Guestless>> waiting;  // connections that are no pages, the oldest first
  std::size_t n_pages = 0;
  std::function<void()> pages_changed;
};

// Serves whoever it is until it goes.
void receive(boost::asio::ip::tcp::socket socket, House& house);

}  // namespace kdray::view
