// What    Who may talk to the server: the token in the page's address, and the names by which a browser may
//         have come here.
// Why     Any page that is open in the user's browser can send requests to 127.0.0.1, and by DNS rebinding
//         under a name of its own. It doesn't know the token, and its own name stands in Host and Origin.
// Shape   The names are those of the loopback and the address that the server is bound to, at any port, since
//         `ssh -L` may give it another one. Addresses in numbers can't be rebound.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kdray::view {

// 128 random bits, as 32 hexadecimal digits.
class Token {
 public:
  Token();
  const std::string& text() const { return text_; }
  // Takes as long for any text of that length.
  bool is(std::string_view text) const;

 private:
  std::string text_;
};

// "localhost" of "localhost:8080", "[::1]" of "[::1]:80", in small letters; none for what is no such field.
std::optional<std::string> name_in_host(std::string_view host);

class Names {
 public:
  // `bound`: the address, in numbers. One that stands for all of the machine's lets any address in numbers
  // pass, and the machine's own name.
  explicit Names(const std::string& bound);

  bool allow_host(std::string_view host) const;
  // The page itself, and no other: http or https at just this Host.
  bool allow_origin(std::string_view origin, std::string_view host) const;

 private:
  std::string bound_, machine_;
  bool all_ = false;
};

// Of the Cookie field, the value of one; empty: it isn't there.
std::string_view cookie_in(std::string_view field, std::string_view name);

// "[::1]" for "::1", since colons part a port in addresses of pages.
std::string in_brackets(const std::string& address);

bool is_loopback(const std::string& address);

}  // namespace kdray::view
