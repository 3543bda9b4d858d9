#include "apps/view/http.h"

#include <fmt/format.h>

#include "apps/view/page.h"

namespace kdray::view {

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
