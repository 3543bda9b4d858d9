// What    The answers to plain requests: the page's files, and a cookie for the token. And who may talk to
//         the server at all: who has the token in the page's address, under the names by which a browser may
//         have come here. All of it is a function of the request; connection.cpp reads and writes the bytes.
// Why     Any page that is open in the user's browser can send requests to 127.0.0.1, and by DNS rebinding
//         under a name of its own. It doesn't know the token, and its own name stands in Host and Origin.
// Shape   GET and HEAD of a file; POST /session with the token. A path that was asked for is only compared
//         with the names of the embedded files (host/apps/view/page), and never looked for anywhere.
//         The names are those of the loopback and the address that the server is bound to, at any port, since
//         `ssh -L` may give it another one. Addresses in numbers can't be rebound.
// Errors  403 foreign Host or Origin, or a wrong token; 404, 405, 400.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kdray::view {

// The token: 128 random bits, as 32 hexadecimal digits.
class Token {
 public:
  Token();
  const std::string& text() const { return text_; }
  // Compares; takes the same time for all texts of that length.
  bool is(std::string_view text) const;

 private:
  std::string text_;
};

// Returns the name in a Host field, in small letters: "localhost" of "localhost:8080", "[::1]" of "[::1]:80";
// none for what is no such field.
std::optional<std::string> name_in_host(std::string_view host);

class Names {
 public:
  // `bound`: the address, in numbers. An address that stands for all of the machine's allows any address in
  // numbers, and the machine's own name.
  explicit Names(const std::string& bound);

  bool allow_host(std::string_view host) const;
  // Allows the page itself alone: http or https at just this Host.
  bool allow_origin(std::string_view origin, std::string_view host) const;

 private:
  std::string bound_, machine_;
  bool all_ = false;
};

// Returns the value of one cookie in a Cookie field; empty: it isn't there.
std::string_view cookie_in(std::string_view field, std::string_view name);

// Returns "[::1]" for "::1", since a colon begins the port in the address of a page.
std::string in_brackets(const std::string& address);

bool is_loopback(const std::string& address);

// A file of the page, embedded, so that nothing is read at run time.
struct PageFile {
  std::string_view path;  // "/main.js"
  std::string_view text;
};

std::span<const PageFile> page_files();

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

// Returns whether a WebSocket may be opened: it may from the page itself.
bool may_connect(const Request& request, const AccessPolicy& access);
// Returns whether the request's cookie has the token.
bool knows_token(const Request& request, const AccessPolicy& access);

}  // namespace kdray::view
