// What    What all connections of a server share: its limits, its access policy, the handler of its clients,
//         and the list of connections that are no pages (yet).
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <list>
#include <memory>

#include "apps/view/http.h"
#include "apps/view/server.h"

namespace kdray::view {

// A connection before it is a page.
class PendingConnection {
 public:
  virtual ~PendingConnection() = default;
  virtual void close() = 0;
};

struct ServerContext {
  AccessPolicy access;
  Limits limits;
  ClientHandler* handler = nullptr;
  std::list<std::weak_ptr<PendingConnection>> pending;  // the oldest first
  std::size_t n_pages = 0;
  std::function<void()> pages_changed;
};

// Serves a connection until it closes.
void serve(boost::asio::ip::tcp::socket socket, ServerContext& context);

}  // namespace kdray::view
