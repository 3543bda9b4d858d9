#include "apps/view/http.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"

namespace kdray::view {

namespace {

constexpr std::size_t kMostHost = 255;

std::string small(std::string_view text) {
  std::string letters(text);
  for (char& c : letters) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

bool is_v4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

bool is_v6(const std::string& text) {
  in6_addr address{};
  return inet_pton(AF_INET6, text.c_str(), &address) == 1;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_name(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
}

std::string machine_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? small(name.data()) : std::string();
}

}  // namespace

Token::Token() {
  std::array<unsigned char, 16> bits{};
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
    throw Error(ErrorCode::internal, "the system has no random numbers for the page's token");
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (const unsigned char byte : bits) (text_ += kDigits[byte >> 4]) += kDigits[byte & 15];
}

bool Token::is(std::string_view text) const {
  if (text.size() != text_.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < text.size(); ++i) different |= static_cast<unsigned>(text[i] ^ text_[i]);
  return different == 0;
}

std::optional<std::string> name_in_host(std::string_view host) {
  if (host.size() > kMostHost) return std::nullopt;
  const bool bracketed = host.starts_with('[');
  const std::size_t end = bracketed ? host.find(']') : host.find(':');
  if (bracketed && end == std::string_view::npos) return std::nullopt;
  const std::string_view name = host.substr(0, bracketed ? end + 1 : end);
  const std::string_view rest = host.substr(name.size());
  if (!rest.empty() && !(rest[0] == ':' && is_port(rest.substr(1)))) return std::nullopt;
  const bool good = bracketed ? is_v6(std::string(name.substr(1, name.size() - 2))) : is_name(name);
  if (!good) return std::nullopt;
  return small(name);
}

Names::Names(const std::string& bound)
    : bound_(in_brackets(bound)), machine_(machine_name()), all_(bound == "0.0.0.0" || bound == "::") {}

bool Names::allow_host(std::string_view host) const {
  const std::optional<std::string> name = name_in_host(host);
  if (!name) return false;
  if (*name == "localhost" || *name == "127.0.0.1" || *name == "[::1]" || *name == bound_) return true;
  return all_ && (name->starts_with('[') || is_v4(*name) || *name == machine_);
}

bool Names::allow_origin(std::string_view origin, std::string_view host) const {
  if (!allow_host(host)) return false;
  const std::string wanted = small(host), given = small(origin);
  return given == "http://" + wanted || given == "https://" + wanted;
}

std::string_view cookie_in(std::string_view field, std::string_view name) {
  while (!field.empty()) {
    const std::size_t end = std::min(field.find(';'), field.size());
    std::string_view one = field.substr(0, end);
    field.remove_prefix(std::min(end + 1, field.size()));
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.size() > name.size() && one.starts_with(name) && one[name.size()] == '=')
      return one.substr(name.size() + 1);
  }
  return {};
}

std::string in_brackets(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

bool is_loopback(const std::string& address) {
  return (is_v4(address) && address.starts_with("127.")) || address == "::1";
}

namespace {

constexpr std::string_view kText = "text/plain; charset=utf-8";

std::string_view type_of(std::string_view path) {
  if (path.ends_with(".html")) return "text/html; charset=utf-8";
  if (path.ends_with(".css")) return "text/css; charset=utf-8";
  return "text/javascript; charset=utf-8";
}

// The page runs its own files alone, and talks to this server alone. Some browsers don't count WebSockets
// to 'self', so they are named; Host has been checked. A page that has this one in a frame learns nothing of
// it, and has no token unless somebody gave it one.
std::string policy(const Request& request, bool framed) {
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
      "'self' "
      "ws://{0} wss://{0}; base-uri 'none'; form-action 'none'; frame-ancestors {1}",
      request.host,
      framed ? "http://localhost:* http://127.0.0.1:* https://localhost:* https://127.0.0.1:*" : "'none'");
}

Response refuse(int status, std::string_view why) {
  return {status, kText, why, {{"Connection", "close"}}};
}

Response file(const Request& request, bool framed) {
  std::string_view path = request.target.substr(0, request.target.find('?'));
  if (path == "/") path = "/index.html";
  for (const PageFile& f : page_files())
    if (f.path == path)
      return {200, type_of(path), f.text, {{"Content-Security-Policy", policy(request, framed)}}};
  return refuse(404, "there is no such file\n");
}

Response session(const Request& request, const AccessPolicy& access) {
  if (!request.origin.empty() && !access.names.allow_origin(request.origin, request.host))
    return refuse(403, "this is for the page itself\n");
  if (!access.token.is(request.body))
    return refuse(403, "wrong token: open the address that kdray view has printed\n");
  return {204,
          {},
          {},
          {{"Set-Cookie",
            fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/", access.cookie, access.token.text())}}};
}

}  // namespace

Response answer(const Request& request, const AccessPolicy& access) {
  if (!access.names.allow_host(request.host)) return refuse(403, "kdray view is not known by this name\n");
  if (request.method == "POST" && request.target == "/session") return session(request, access);
  if (request.method != "GET" && request.method != "HEAD") return refuse(405, "GET or HEAD\n");
  return file(request, access.framed);
}

bool may_connect(const Request& request, const AccessPolicy& access) {
  return request.target == "/socket" && access.names.allow_origin(request.origin, request.host);
}

bool knows_token(const Request& request, const AccessPolicy& access) {
  return access.token.is(cookie_in(request.cookie, access.cookie));
}

}  // namespace kdray::view
