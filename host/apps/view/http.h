// What    The answers to plain requests: the page's files, and a cookie for the token. All of it is a
//         function of the request; connection.cpp reads and writes the bytes.
// Shape   GET and HEAD of a file; POST /session with the token. Nothing is ever looked for by a path that was
//         asked for: it is compared with the names of the embedded files.
// Errors  403 foreign Host or Origin, or a wrong token; 404, 405, 400.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/view/address.h"

namespace kdray::view {

// What counts of a request.
struct Request {
  std::string_view method, target, host, origin, cookie, body;
};

struct Response {
  int status = 200;
  std::string_view type;  // of the body
  std::string_view body;
  std::vector<std::pair<std::string_view, std::string>> fields = {};  // more of the head
};

// Who may reach the server, and what its cookie is called.
struct AccessPolicy {
  Names names;
  Token token;
  std::string cookie;   // the name of this server's own: cookies don't know ports
  bool framed = false;  // whether pages at the loopback may have this one in a frame
};

Response answer(const Request& request, const AccessPolicy& access);

// Whether a WebSocket may be opened: from the page itself.
bool may_connect(const Request& request, const AccessPolicy& access);
// Whether its cookie has the token.
bool knows_token(const Request& request, const AccessPolicy& access);

}  // namespace kdray::view
